#include "apps/movie/paint.hpp"

#include <fmt/format.h>

#include <iterator>

#include "apps/movie/things.hpp"

namespace tape::movie {
namespace {
using render::ColorBy;

const Vec3 kTapeFront(0.86, 0.66, 0.30), kTapeBack(0.93, 0.82, 0.55);  // sRGB; the back is the sticky side
const Vec3 kTracked(0.80, 0.10, 0.14);
/// By TapePart.
const struct {
  const char* name;
  Vec3 color;
} kParts[] = {{"free tape", kTapeFront}, {"collar", {0.16, 0.60, 0.58}}, {"cluster", {0.30, 0.36, 0.50}}, {"asleep", {0.66, 0.60, 0.74}}};
const Vec3 kBodyColors[] = {{0.45, 0.55, 0.68}, {0.55, 0.62, 0.50}, {0.66, 0.50, 0.48}, {0.58, 0.52, 0.66},
                            {0.62, 0.62, 0.60}, {0.42, 0.60, 0.60}, {0.68, 0.54, 0.62}, {0.50, 0.50, 0.52}};

/// The links of a robot, "robot:link", are one thing.
std::string thing(const cosim::RecordedObject& object) { return object.name.substr(0, object.name.find(':')); }
Vec3 object_color(const RecordedMesh& mesh, std::size_t o) {
  const auto& objects = mesh.objects;
  if (objects[o].strip) return kTapeFront;
  std::size_t count = 0;  // of things up to this one, but for strips
  for (std::size_t i = 0; i <= o; ++i) count += !objects[i].strip && (i == 0 || thing(objects[i]) != thing(objects[i - 1]));
  return kBodyColors[(count - 1) % std::size(kBodyColors)];
}

/// One for each vertex; none where each thing has one colour.
std::vector<Vec3> vertex_colors(const ViewParams& view, const Stage& stage, const RecordedMesh& mesh, const RecordedFrame& frame,
                                const std::vector<Vec3>& x) {
  if (view.color == ColorBy::material && view.track < 0) return {};
  std::vector<Vec3> colors(x.size(), Vec3::Zero());
  for (std::size_t o = 0; o < mesh.objects.size(); ++o)
    for (int t = mesh.objects[o].first_triangle; t < mesh.objects[o].first_triangle + mesh.objects[o].triangles; ++t)
      for (int v : mesh.triangles[static_cast<std::size_t>(t)]) colors[static_cast<std::size_t>(v)] = object_color(mesh, o);
  if (view.color == ColorBy::part)
    for (std::size_t v = 0; v < frame.part.size(); ++v) colors[v] = kParts[static_cast<std::size_t>(frame.part[v])].color;
  if (!by_thing(view.color)) colors = render::colors_of(color_values(view.color, mesh, frame, x), stage.bar);
  if (view.track >= 0)
    for (int v : row_at(mesh, view.track)) colors[static_cast<std::size_t>(v)] = kTracked;
  return colors;
}

render::Mesh object_mesh(const RecordedMesh& recorded, std::size_t o, const std::vector<Vec3>& x, const std::vector<Vec3>& colors) {
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
  if (colors.empty()) mesh.colors = {object_color(recorded, o)};
  if (colors.empty() && object.strip) mesh.back_color = kTapeBack;
  if (object.strip) mesh.crease = 180;
  return mesh;
}
}  // namespace

render::RenderScene painted(const ViewParams& view, const Stage& stage, const RecordedMesh& mesh, const RecordedFrame& frame) {
  const std::vector<Vec3> x = vertex_positions(mesh, frame);
  const std::vector<Vec3> colors = vertex_colors(view, stage, mesh, frame, x);
  render::RenderScene scene{.bounds = stage.bounds};
  if (view.ground) scene.ground = stage.ground;
  for (std::size_t o = 0; o < mesh.objects.size(); ++o) scene.meshes.push_back(object_mesh(mesh, o, x, colors));
  return scene;
}

render::Legend legend_of(const ViewParams& view, const Stage& stage, const RecordedMesh& mesh) {
  render::Legend legend;
  if (!by_thing(view.color)) legend.bar = stage.bar;
  if (view.color == ColorBy::part)
    for (const auto& part : kParts) legend.swatches.push_back({part.name, part.color});
  const auto& objects = mesh.objects;
  for (std::size_t o = 0; o < objects.size(); ++o) {
    if (o > 0 && thing(objects[o]) == thing(objects[o - 1])) continue;
    if (view.color == ColorBy::material || (by_thing(view.color) && !objects[o].strip))
      legend.swatches.push_back({thing(objects[o]), object_color(mesh, o)});
  }
  if (view.track >= 0) legend.swatches.push_back({fmt::format("row at {:g} m", view.track), kTracked});
  return legend;
}
}  // namespace tape::movie
