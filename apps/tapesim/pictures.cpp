#include "apps/tapesim/pictures.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <set>

#include "apps/render/renderer.hpp"
#include "apps/report/strain.hpp"
#include "apps/tapesim/interrupt.hpp"
#include "apps/tapesim/progress.hpp"
#include "cosim/run/summary.hpp"

namespace tape::tapesim {
namespace {
using cosim::RecordedFrame, cosim::RecordedMesh, cosim::StateReader;
using render::ColorBy;

const Vec3 kTapeFront(0.86, 0.66, 0.30), kTapeBack(0.93, 0.82, 0.55);  // sRGB; the back is the sticky side
const Vec3 kTracked(0.80, 0.10, 0.14);
/// By TapePart.
const struct {
  const char* name;
  Vec3 color;
} kParts[] = {{"free tape", kTapeFront}, {"collar", {0.16, 0.60, 0.58}}, {"cluster", {0.30, 0.36, 0.50}}};
const Vec3 kBodyColors[] = {{0.45, 0.55, 0.68}, {0.55, 0.62, 0.50}, {0.66, 0.50, 0.48}, {0.58, 0.52, 0.66}, {0.62, 0.62, 0.60}};

/// Draws recorded states of one recording with its cameras side by side and one scale of colours.
class Studio {
 public:
  Studio(const StateReader& recording, const PictureParams& params)
      : recording_(recording), params_(params), views_(make_views()), renderer_(views_[0].camera.width, views_[0].camera.height) {
    look_through();
  }
  int width() const { return views_[0].camera.width * static_cast<int>(views_.size()); }
  int height() const { return views_[0].camera.height; }

  render::Picture draw(const RecordedFrame& frame) {
    const RecordedMesh& mesh = recording_.mesh(frame.mesh);
    const std::vector<Vec3> x = vertex_positions(mesh, frame);
    render::RenderScene scene{.bounds = everything_, .caption = fmt::format("{}   t = {:.2f} s", mesh.scene, frame.time)};
    if (params_.view.ground) scene.ground = everything_.min().z();
    const std::vector<Vec3> colors = vertex_colors(frame, x);
    for (std::size_t o = 0; o < mesh.objects.size(); ++o) scene.meshes.push_back(object_mesh(mesh, o, x, colors));
    scene.legends.push_back(legend());
    std::vector<render::Picture> pictures;
    for (View& view : views_) {
      render::Camera camera = view.camera;
      if (!view.follow.empty()) camera.X_WC.position += place(view.follow, frame) - view.start;
      if (!view.mount.empty()) camera.X_WC = on(frame_of(view.mount, frame), camera.X_WC);
      pictures.push_back(renderer_.draw(scene, camera));
      scene.legends.clear(), scene.caption.clear();  // once
    }
    return render::side_by_side(pictures);
  }

 private:
  /// A camera, and the thing whose middle it moves along with.
  struct View {
    render::Camera camera;
    std::string follow = {};
    Vec3 start = Vec3::Zero();  ///< [m] its middle in the first state
    std::string mount = {};     ///< what its pose is in the frame of
  };
  static Pose on(const Pose& X_WB, const Pose& X_BC) { return {X_WB.rotation * X_BC.rotation, apply(X_WB, X_BC.position)}; }
  /// Frame of a body or a link. @throws InputError if nothing is named so
  Pose frame_of(const std::string& name, const RecordedFrame& frame) const {
    const RecordedMesh& mesh = recording_.mesh(frame.mesh);
    std::size_t body = 0;
    for (const cosim::RecordedObject& object : mesh.objects) {
      if (object.strip) continue;
      if (object.name == name) return frame.bodies[body];
      ++body;
    }
    for (std::size_t r = 0; r < mesh.robots.size(); ++r)
      for (std::size_t l = 0; l < mesh.robots[r].links.size(); ++l)
        if (mesh.robots[r].name + ":" + mesh.robots[r].links[l] == name) return cosim::to_tape(frame.robots[r].links[l]);
    throw InputError("camera.mount = " + name + ": no body and no link robot:link has this name");
  }
  /// The links of a robot, "robot:link", are one thing.
  static std::string thing(const cosim::RecordedObject& object) { return object.name.substr(0, object.name.find(':')); }
  Vec3 object_color(std::size_t o) const {
    const auto& objects = recording_.mesh().objects;
    if (objects[o].strip) return kTapeFront;
    std::size_t first = o;  // of this thing
    while (first > 0 && thing(objects[first - 1]) == thing(objects[o])) --first;
    return kBodyColors[first % std::size(kBodyColors)];
  }
  /// Whether colours tell things apart, not values.
  bool by_thing() const { return params_.view.color == ColorBy::material || params_.view.color == ColorBy::part; }

  render::Legend legend() const {
    render::Legend legend;
    if (!by_thing()) legend.bar = bar_;
    if (params_.view.color == ColorBy::part)
      for (std::size_t p = 0; p < std::size(kParts); ++p) legend.swatches.push_back({kParts[p].name, kParts[p].color});
    const auto& objects = recording_.mesh().objects;
    for (std::size_t o = 0; o < objects.size(); ++o) {
      if (o > 0 && thing(objects[o]) == thing(objects[o - 1])) continue;
      if (params_.view.color == ColorBy::material || (by_thing() && !objects[o].strip))
        legend.swatches.push_back({thing(objects[o]), object_color(o)});
    }
    if (params_.view.track >= 0) legend.swatches.push_back({fmt::format("row at {:g} m", params_.view.track), kTracked});
    return legend;
  }

  std::vector<Vec3> vertex_colors(const RecordedFrame& frame, const std::vector<Vec3>& x) const {
    const RecordedMesh& mesh = recording_.mesh(frame.mesh);
    if (params_.view.color == ColorBy::material && params_.view.track < 0) return {};
    std::vector<Vec3> colors(x.size(), Vec3::Zero());
    for (std::size_t o = 0; o < mesh.objects.size(); ++o)
      for (int t = mesh.objects[o].first_triangle; t < mesh.objects[o].first_triangle + mesh.objects[o].triangles; ++t)
        for (int v : mesh.triangles[static_cast<std::size_t>(t)]) colors[static_cast<std::size_t>(v)] = object_color(o);
    if (params_.view.color == ColorBy::part)
      for (std::size_t v = 0; v < frame.part.size(); ++v) colors[v] = kParts[static_cast<std::size_t>(frame.part[v])].color;
    if (!by_thing()) colors = render::colors_of(values(frame, x), bar_);
    if (params_.view.track >= 0)
      for (int v : row_at(mesh, params_.view.track)) colors[static_cast<std::size_t>(v)] = kTracked;
    return colors;
  }

  /// Vertices of the row of the first strip that lies nearest to this place [m] at rest.
  static std::vector<int> row_at(const RecordedMesh& mesh, Real along) {
    std::vector<int> of_strip, row;
    for (const cosim::RecordedObject& object : mesh.objects) {
      if (!object.strip) continue;
      of_strip = vertices_of(mesh, object);
      break;
    }
    const auto off = [&](int v) { return std::fabs(mesh.rest[static_cast<std::size_t>(v)].x() - along); };
    Real nearest = std::numeric_limits<Real>::infinity();
    for (int v : of_strip) nearest = std::min(nearest, off(v));
    for (int v : of_strip)
      if (off(v) < nearest + 1e-9) row.push_back(v);
    return row;
  }
  static std::vector<int> vertices_of(const RecordedMesh& mesh, const cosim::RecordedObject& object) {
    std::set<int> found;
    for (int t = object.first_triangle; t < object.first_triangle + object.triangles; ++t)
      for (int v : mesh.triangles[static_cast<std::size_t>(t)]) found.insert(v);
    return {found.begin(), found.end()};
  }
  /// @throws InputError if nothing is named so
  static std::vector<int> vertices_named(const RecordedMesh& mesh, const std::string& name) {
    std::string names;
    for (const cosim::RecordedObject& object : mesh.objects) {
      const std::vector<int> all = vertices_of(mesh, object);
      if (object.name == name) return all;
      names += (names.empty() ? "" : ", ") + object.name;
      if (!object.strip) continue;
      names += ", " + object.name + ".tip";
      if (object.name + ".tip" != name) continue;
      Real length = 0;
      std::vector<int> tip;
      const auto along = [&](int v) { return mesh.rest[static_cast<std::size_t>(v)].x(); };
      for (int v : all) length = std::max(length, along(v));
      std::copy_if(all.begin(), all.end(), std::back_inserter(tip), [&](int v) { return along(v) > length - 1e-9; });
      return tip;
    }
    throw InputError("camera.follow = " + name + ": no thing of the scene has this name (allowed: " + names + ")");
  }
  Vec3 place(const std::string& name, const RecordedFrame& frame) const {
    const RecordedMesh& mesh = recording_.mesh(frame.mesh);
    const std::vector<int> vertices = vertices_named(mesh, name);
    const std::vector<Vec3> x = vertex_positions(mesh, frame);
    Vec3 sum = Vec3::Zero();
    for (int v : vertices) sum += x[static_cast<std::size_t>(v)];
    return sum / static_cast<Real>(vertices.size());
  }

  render::Mesh object_mesh(const RecordedMesh& recorded, std::size_t o, const std::vector<Vec3>& x, const std::vector<Vec3>& colors) const {
    const cosim::RecordedObject& object = recorded.objects[o];
    render::Mesh mesh{.colors = {}};
    std::vector<int> place(x.size(), -1);
    for (int t = object.first_triangle; t < object.first_triangle + object.triangles; ++t) {
      Index3 triangle = recorded.triangles[static_cast<std::size_t>(t)];
      for (int& v : triangle) {
        int& at = place[static_cast<std::size_t>(v)];
        if (at < 0) {
          at = static_cast<int>(mesh.vertices.size());
          mesh.vertices.push_back(x[static_cast<std::size_t>(v)]);
          if (!colors.empty()) mesh.colors.push_back(colors[static_cast<std::size_t>(v)]);
        }
        v = at;
      }
      mesh.triangles.push_back(triangle);
    }
    if (colors.empty()) mesh.colors = {object_color(o)};
    if (colors.empty() && object.strip) mesh.back_color = kTapeBack;
    if (object.strip) mesh.crease = 180;
    return mesh;
  }

  /// Of strips; forces of bodies only where there is no strip, for they stand on vertices that may be far from where the contact is.
  std::vector<Real> values(const RecordedFrame& frame, const std::vector<Vec3>& x) const {
    const RecordedMesh& mesh = recording_.mesh(frame.mesh);
    if (params_.view.color == ColorBy::contact_force) {
      std::vector<Real> force = frame.contact_force;
      if (mesh.strip_vertices > 0) std::fill(force.begin() + mesh.strip_vertices, force.end(), std::numeric_limits<Real>::quiet_NaN());
      return force;
    }
    if (params_.view.color == ColorBy::adhesion) {
      std::vector<Real> engagement = frame.engagement;
      engagement.resize(x.size(), std::numeric_limits<Real>::quiet_NaN());
      return engagement;
    }
    if (params_.view.color == ColorBy::tension) {
      std::vector<report::FilmStiffness> film(mesh.triangles.size());
      for (const cosim::RecordedObject& o : mesh.objects)
        for (int t = o.first_triangle; t < o.first_triangle + o.triangles; ++t) film[static_cast<std::size_t>(t)] = {o.stretch, o.poisson};
      return report::vertex_tension(mesh.triangles, mesh.rest, x, mesh.strip_vertices, film);
    }
    return report::vertex_strain(mesh.triangles, mesh.rest, x, mesh.strip_vertices);
  }

  /// The bounds of the whole motion, and the range of values that are to be seen in it: up to what 95 % of the states stay below, so
  /// that a short impact does not leave all others dark.
  void look_through() {
    std::vector<Real> largest;  // of each state
    for (int i = 0; i < recording_.frames(); ++i) {
      const RecordedFrame frame = recording_.frame(i);
      const std::vector<Vec3> x = vertex_positions(recording_.mesh(frame.mesh), frame);
      for (const Vec3& p : x) everything_.extend(p);
      if (by_thing() || params_.view.color == ColorBy::adhesion) continue;
      largest.push_back(0);
      for (const Real value : values(frame, x))
        if (value > largest.back()) largest.back() = value;
    }
    if (params_.view.color == ColorBy::adhesion) {
      bar_ = {"adhesion left (beta; bond: 1)", "", 0, 1};
      return;
    }
    if (by_thing()) return;
    const bool strain = params_.view.color == ColorBy::strain, tension = params_.view.color == ColorBy::tension;
    const std::string title = strain ? "largest strain" : tension ? "membrane tension" : "contact force";
    const cosim::Distribution peaks = cosim::distribution(largest);
    bar_ = render::bar_over({0, peaks.p95}, title + (peaks.max > peaks.p95 ? ", peaks cut" : ""), strain ? "" : tension ? "N/m" : "N");
    bar_.low = 0;  // what is below is slack, or there is none
  }

  std::vector<View> make_views() const {
    const int all = static_cast<int>(params_.cameras.size()), height = params_.video.height;
    const int width = all < 2 ? params_.video.width : params_.video.width / all / 2 * 2;
    std::vector<View> views;
    for (const CameraParams& camera : params_.cameras) {
      if (const auto* pinhole = std::get_if<render::PinholeSettings>(&camera))
        views.push_back({.camera = render::Camera::make(*pinhole), .mount = pinhole->mount});
      const auto* look = std::get_if<render::LookAtSettings>(&camera);
      if (!look) continue;
      View view{.camera = render::Camera::make(*look, width, height), .mount = look->mount};
      if (!look->mount.empty() && !look->follow.empty()) throw InputError("camera: follow and mount exclude each other");
      if (!look->follow.empty()) {
        view.follow = look->follow;
        view.start = place(view.follow, recording_.frame(0));
      }
      views.push_back(view);
    }
    if (views.empty()) views.push_back({render::Camera::make(render::overview(moving_bounds(), width, height), width, height)});
    return views;
  }

  /// Of strips and of bodies that move.
  render::Bounds moving_bounds() const {
    render::Bounds moving, all;
    const std::vector<Pose> first = recording_.frame(0).bodies;
    for (int i = 0; i < recording_.frames(); ++i) {
      const RecordedFrame frame = recording_.frame(i);
      const RecordedMesh& mesh = recording_.mesh(frame.mesh);
      const std::vector<Vec3> x = vertex_positions(mesh, frame);
      for (std::size_t v = 0; v < x.size(); ++v) {
        all.extend(x[v]);
        const auto moved = [&](std::size_t b) {
          return frame.bodies[b].position != first[b].position || frame.bodies[b].rotation != first[b].rotation;
        };
        if (mesh.body[v] < 0 || moved(static_cast<std::size_t>(mesh.body[v]))) moving.extend(x[v]);
      }
    }
    return moving.isEmpty() ? all : moving;
  }

  const StateReader& recording_;
  PictureParams params_;
  std::vector<View> views_;
  render::Renderer renderer_;
  render::Bounds everything_;
  render::ColorBar bar_;
};

/// A calibrated camera brings its own size; the video must have it too.
video::VideoSettings video_settings(const PictureParams& params, int width, int height) {
  video::VideoSettings settings = params.video;
  settings.width = width;
  settings.height = height;
  return settings;
}

void require_frames(const StateReader& recording) {
  if (recording.frames() == 0) throw InputError("the recording holds no state");
}
}  // namespace

void require_video(const PictureParams& params) {
  const auto* pinhole = params.cameras.empty() ? nullptr : std::get_if<render::PinholeSettings>(&params.cameras[0]);
  const int cameras = static_cast<int>(params.cameras.size());
  require_valid(video_settings(params, pinhole ? cameras * pinhole->calibration.width : params.video.width,
                               pinhole ? pinhole->calibration.height : params.video.height));
}

bool write_video(const StateReader& recording, const PictureParams& params, const std::filesystem::path& file) {
  require_frames(recording);
  Studio studio(recording, params);
  video::VideoWriter video(file, video_settings(params, studio.width(), studio.height()));
  const Real start = recording.frame(0).time, length = recording.frame(recording.frames() - 1).time - start;
  const int pictures = static_cast<int>(std::floor(length * params.video.rate + 1e-6)) + 1;
  Progress progress("video", pictures);
  int shown = -1, next = 0;
  render::Picture picture;
  for (int k = 0; k < pictures; ++k) {
    const Real time = start + k / params.video.rate;
    while (next < recording.frames() && recording.frame(next).time <= time + 1e-9) ++next;
    if (next - 1 != shown) picture = studio.draw(recording.frame(shown = next - 1));
    video.add(picture);
    if (interrupted()) return false;
    progress.update(k + 1);
  }
  video.finish();
  return true;
}

void write_still(const StateReader& recording, const PictureParams& params, int frame, const std::filesystem::path& file) {
  require_frames(recording);
  const int index = frame < 0 ? frame + recording.frames() : frame;
  if (index < 0 || index >= recording.frames())
    throw SettingsError("--still", std::to_string(frame), Range::closed(-recording.frames(), recording.frames() - 1).text());
  Studio studio(recording, params);
  render::write_png(file, studio.draw(recording.frame(index)));
}
}  // namespace tape::tapesim
