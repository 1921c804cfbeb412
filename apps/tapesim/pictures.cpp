#include "apps/tapesim/pictures.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

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
const Vec3 kBodyColors[] = {{0.45, 0.55, 0.68}, {0.55, 0.62, 0.50}, {0.66, 0.50, 0.48}, {0.58, 0.52, 0.66}, {0.62, 0.62, 0.60}};

/// Draws recorded states of one recording with one camera and one scale of colours.
class Studio {
 public:
  Studio(const StateReader& recording, const PictureParams& params)
      : recording_(recording), params_(params), camera_(make_camera()), renderer_(camera_.width, camera_.height) {
    look_through();
  }
  int width() const { return camera_.width; }
  int height() const { return camera_.height; }

  render::Picture draw(const RecordedFrame& frame) {
    const RecordedMesh& mesh = recording_.mesh();
    const std::vector<Vec3> x = vertex_positions(mesh, frame);
    render::RenderScene scene{.bounds = everything_, .caption = fmt::format("{}   t = {:.2f} s", mesh.scene, frame.time)};
    if (params_.view.ground) scene.ground = everything_.min().z();
    const std::vector<Vec3> colors =
        params_.view.color == ColorBy::material ? std::vector<Vec3>() : render::colors_of(values(frame, x), bar_);
    render::Legend legend;
    if (!colors.empty()) legend.bar = bar_;
    for (std::size_t o = 0; o < mesh.objects.size(); ++o) {
      scene.meshes.push_back(object_mesh(o, x, colors));
      if (colors.empty()) legend.swatches.push_back({mesh.objects[o].name, object_color(o)});
    }
    scene.legends.push_back(legend);
    return renderer_.draw(scene, camera_);
  }

 private:
  Vec3 object_color(std::size_t o) const {
    return recording_.mesh().objects[o].strip ? kTapeFront : kBodyColors[o % std::size(kBodyColors)];
  }

  render::Mesh object_mesh(std::size_t o, const std::vector<Vec3>& x, const std::vector<Vec3>& colors) const {
    const RecordedMesh& recorded = recording_.mesh();
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
    const RecordedMesh& mesh = recording_.mesh();
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
    return report::vertex_strain(mesh.triangles, mesh.rest, x, mesh.strip_vertices);
  }

  /// The bounds of the whole motion, and the range of values that are to be seen in it: up to what 95 % of the states stay below, so
  /// that a short impact does not leave all others dark.
  void look_through() {
    std::vector<Real> largest;  // of each state
    for (int i = 0; i < recording_.frames(); ++i) {
      const RecordedFrame frame = recording_.frame(i);
      const std::vector<Vec3> x = vertex_positions(recording_.mesh(), frame);
      for (const Vec3& p : x) everything_.extend(p);
      if (params_.view.color == ColorBy::material || params_.view.color == ColorBy::adhesion) continue;
      largest.push_back(0);
      for (const Real value : values(frame, x))
        if (value > largest.back()) largest.back() = value;
    }
    if (params_.view.color == ColorBy::adhesion) {
      bar_ = {"adhesion left (beta; bond: 1)", "", 0, 1};
      return;
    }
    const bool strain = params_.view.color == ColorBy::strain;
    const cosim::Distribution peaks = cosim::distribution(largest);
    const std::string cut = peaks.max > peaks.p95 ? ", peaks cut" : "";
    bar_ = render::bar_over({0, peaks.p95}, (strain ? "largest strain" : "contact force") + cut, strain ? "" : "N");
    bar_.low = 0;  // both are magnitudes
  }

  render::Camera make_camera() const {
    const int width = params_.video.width, height = params_.video.height;
    if (const auto* pinhole = std::get_if<render::PinholeSettings>(&params_.camera)) return render::Camera::make(*pinhole);
    if (const auto* look = std::get_if<render::LookAtSettings>(&params_.camera)) return render::Camera::make(*look, width, height);
    return render::Camera::make(render::overview(moving_bounds(), width, height), width, height);
  }

  /// Of strips and of bodies that move.
  render::Bounds moving_bounds() const {
    const RecordedMesh& mesh = recording_.mesh();
    render::Bounds moving, all;
    const std::vector<Vec3> first = vertex_positions(mesh, recording_.frame(0));
    for (int i = 0; i < recording_.frames(); ++i) {
      const std::vector<Vec3> x = vertex_positions(mesh, recording_.frame(i));
      for (std::size_t v = 0; v < x.size(); ++v) {
        all.extend(x[v]);
        if (mesh.body[v] < 0 || x[v] != first[v]) moving.extend(x[v]);
      }
    }
    return moving.isEmpty() ? all : moving;
  }

  const StateReader& recording_;
  PictureParams params_;
  render::Camera camera_;
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
  const auto* pinhole = std::get_if<render::PinholeSettings>(&params.camera);
  require_valid(video_settings(params, pinhole ? pinhole->width : params.video.width, pinhole ? pinhole->height : params.video.height));
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
