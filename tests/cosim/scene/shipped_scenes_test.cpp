#include <gtest/gtest.h>

#include <filesystem>

#include "cosim/scene/read_scene.hpp"
#include "tape/math/distance.hpp"
#include "tape/model/strip_mesh.hpp"
using namespace cosim;

namespace {
namespace fs = std::filesystem;
std::vector<fs::path> shipped(const char* folder) {
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(fs::path(TAPE_SOURCE_DIR) / "data" / folder))
    if (entry.path().extension() == ".yaml") files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  return files;
}
/// Marks all keys of a section as known: other tests read those of the solver, the recorder and the cameras.
void know_all(const Reader& reader) {
  if (reader.is_list())
    for (const Reader& item : reader.items()) know_all(item);
  if (reader.is_map())
    for (const std::string& key : reader.keys()) know_all(reader[key]);
}

struct Surface {
  std::string name;
  Real xi;  // [m]
  std::vector<Vec3> x;
  std::vector<tape::Index3> triangles;
  bool is_strip;
  bool outside = false;  // what these have of each other is Bullet's matter
  // Links stand by a roll as it is once settled, which World::build looks at; here it is as wound. Its own gaps
  bool of_roll = false;  // its gaps are those of its layers: tests/tape/step/roll_gaps_test.cpp
  std::vector<tape::Vec2> rest = {};
};
std::vector<Surface> surfaces(const tape::Scene& scene) {
  std::vector<Surface> all;
  for (const tape::Strip& strip : scene.strips) {
    const tape::Film& film = scene.films[strip.film];
    const tape::StripMesh mesh = make_strip_mesh(strip.mesh, film.width, scene.seed);
    all.push_back({strip.name, film.xi, place(mesh, strip), mesh.triangles, true, false, strip.winding.has_value(), mesh.rest});
  }
  for (const tape::Body& body : scene.bodies) {
    Surface s{body.name, body.xi, {}, body.mesh.triangles, false};
    s.outside = body.outside;
    for (const Vec3& v : body.mesh.vertices) s.x.push_back(apply(body.pose, v));
    all.push_back(std::move(s));
  }
  for (const tape::Strip& strip : scene.strips)
    if (strip.winding) all[scene.strips.size() + static_cast<std::size_t>(strip.winding->hub)].of_roll = true;
  return all;
}
/// Smallest distance of a vertex of `a` from a triangle of `b`; within a strip only where the strip itself is `apart` away.
Real distance(const Surface& a, const Surface& b, Real apart) {
  Real smallest = 1;
  for (const tape::Index3& t : b.triangles) {
    const Vec3 centre = (b.x[t[0]] + b.x[t[1]] + b.x[t[2]]) / 3;
    const Real radius = std::max({(b.x[t[0]] - centre).norm(), (b.x[t[1]] - centre).norm(), (b.x[t[2]] - centre).norm()});
    for (std::size_t v = 0; v < a.x.size(); ++v) {
      if ((a.x[v] - centre).norm() - radius > std::min(smallest, 0.01)) continue;
      if (&a == &b && (a.rest[v] - b.rest[t[0]]).norm() < apart) continue;
      const Vec3 x[4] = {a.x[v], b.x[t[0]], b.x[t[1]], b.x[t[2]]};
      smallest = std::min(smallest, tape::combine(tape::closest_vertex_triangle(x).weight, x).norm());
    }
  }
  return smallest;
}
}  // namespace

TEST(ShippedScenes, EveryOneLoadsWithoutUnknownKeys) {
  const std::vector<fs::path> files = shipped("scenes");
  EXPECT_GE(files.size(), 8u);
  for (const fs::path& path : files) {
    const SceneFile file = SceneFile::load(path);
    EXPECT_EQ(read_worlds(file).tape.name, path.stem().string());
    for (const char* section : {"solver", "record", "camera", "cameras", "video", "effects", "cutting"}) know_all(file[section]);
    for (const char* section : {"barrier", "friction", "bending", "membrane", "tether"}) know_all(file[section]);
    EXPECT_NO_THROW(file.require_all_used()) << path;
  }
}

TEST(ShippedScenes, StartWithGapsAboveHalfTheActivationDistance) {
  for (const fs::path& path : shipped("scenes")) {
    const tape::Scene scene = read_worlds(SceneFile::load(path)).tape;
    const std::vector<Surface> all = surfaces(scene);
    for (const Surface& a : all)
      for (const Surface& b : all)
        if ((&a != &b || a.is_strip) && !(a.of_roll && b.of_roll) && !(a.outside && b.outside) && !(a.of_roll && b.outside) &&
            !(a.outside && b.of_roll)) {
          EXPECT_GE(distance(a, b, 0.02) - a.xi - b.xi, 0.5 * scene.dhat()) << path.filename() << ": " << a.name << " and " << b.name;
        }
  }
}

TEST(ShippedFilms, EveryOneLoads) {
  const std::vector<fs::path> files = shipped("tapes");
  EXPECT_GE(files.size(), 2u);
  for (const fs::path& path : files) {
    const SceneFile file = SceneFile::parse("film: " + path.stem().string() + "\n", path.parent_path() / "scene.yaml");
    EXPECT_EQ(load_film(file["film"], file.path()).name, path.stem().string());
  }
}
