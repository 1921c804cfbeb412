#include "cosim/scene/shapes.hpp"

#include <array>
#include <cmath>

#include "cosim/scene/mesh_file.hpp"
#include "cosim/scene/pose.hpp"
#include "cosim/scene/scene_file.hpp"
#include "tape/model/primitives.hpp"

namespace cosim {
namespace {
using tape::TriangleMesh;
namespace fs = std::filesystem;

Real length(const Reader& body, const char* key) { return body[key].number(kSize, "m"); }
int segments(const Reader& body, int fallback) { return body["segments"].integer_or(fallback, Range::closed(3, 2000)); }
int bands(const Reader& body) { return body["bands"].integer_or(1, Range::closed(1, 200)); }

void require_whole(const Reader& where, const std::vector<Real>& numbers) {
  for (const Real n : numbers)
    if (n != std::round(n)) where.fail("are whole numbers");
}
TriangleMesh box(const Reader& body, const fs::path&) {
  const Vec3 cells = body["cells"].vector_or(Vec3::Ones(), Range::closed(1, 200), "");
  require_whole(body["cells"], {cells[0], cells[1], cells[2]});
  return tape::box_mesh(body["size"].vector(kSize, "m"), cells.cast<int>());
}
TriangleMesh sheet(const Reader& body, const fs::path&) {
  const std::vector<Real> size = body["size"].numbers(2, kSize, "m");
  const Reader cells = body["cells"];
  const std::vector<Real> n = cells ? cells.numbers(2, Range::closed(1, 400), "") : std::vector<Real>{1, 1};
  require_whole(cells, n);
  return tape::sheet_mesh({size[0], size[1]}, {static_cast<int>(n[0]), static_cast<int>(n[1])});
}
TriangleMesh cylinder(const Reader& body, const fs::path&) {
  return tape::cylinder_mesh(length(body, "radius"), length(body, "height"), segments(body, 96), bands(body));
}
TriangleMesh ring(const Reader& body, const fs::path&) {
  const Reader inner = body["inner_radius"];
  const Real outer = length(body, "outer_radius");
  return tape::ring_mesh(inner.number({.low = 0, .high = outer, .open_low = true, .open_high = true}, "m"), outer, length(body, "height"),
                         segments(body, 96), bands(body));
}
TriangleMesh sphere(const Reader& body, const fs::path&) {
  return tape::sphere_mesh(length(body, "radius"), body["subdivisions"].integer_or(3, Range::closed(0, 6)));
}
TriangleMesh capsule(const Reader& body, const fs::path&) {
  return tape::capsule_mesh(length(body, "radius"), length(body, "height"), segments(body, 48));
}
TriangleMesh wedge(const Reader& body, const fs::path&) { return tape::wedge_mesh(body["size"].vector(kSize, "m")); }
TriangleMesh spike(const Reader& body, const fs::path&) {
  return tape::spike_mesh(length(body, "radius"), length(body, "height"), segments(body, 4));
}
TriangleMesh mesh(const Reader& body, const fs::path& scene_file) {
  const Reader file = body["file"];
  const fs::path found = find_file(scene_file, "props", file.text());
  if (found.empty()) file.fail("no such file beside the scene, above it, or in data/props");
  return load_mesh(found, body["scale"].number_or(1, Range::above(0, 1e6), ""), file.where() + ": " + file.path());
}

struct Shape {
  const char* name;
  TriangleMesh (*read)(const Reader& body, const fs::path& scene_file);
};
constexpr std::array kShapes{Shape{"box", box},       Shape{"cylinder", cylinder}, Shape{"ring", ring},
                             Shape{"sphere", sphere}, Shape{"capsule", capsule},   Shape{"sheet", sheet},
                             Shape{"wedge", wedge},   Shape{"spike", spike},       Shape{"mesh", mesh}};
}  // namespace

TriangleMesh read_shape(const Reader& body, const fs::path& scene_file) {
  std::vector<std::string> names;
  for (const Shape& shape : kShapes) names.push_back(shape.name);
  return kShapes[choose(body["shape"], names)].read(body, scene_file);
}
}  // namespace cosim
