#include "apps/movie/things.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <optional>
#include <set>

#include "cosim/exchange/exchange.hpp"
#include "tape/core/error.hpp"

namespace tape::movie {
namespace {
struct LinkIndex {
  std::size_t robot, link;
};
std::optional<LinkIndex> find_link(const std::string& name, const RecordedMesh& mesh) {
  for (std::size_t r = 0; r < mesh.robots.size(); ++r)
    for (std::size_t l = 0; l < mesh.robots[r].links.size(); ++l)
      if (mesh.robots[r].name + ":" + mesh.robots[r].links[l] == name) return LinkIndex{r, l};
  return {};
}

/// @throws InputError if nothing is named so
std::vector<int> vertices_named(const RecordedMesh& mesh, const std::string& name) {
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
}  // namespace

std::vector<int> vertices_of(const RecordedMesh& mesh, const cosim::RecordedObject& object) {
  std::set<int> found;
  for (int t = object.first_triangle; t < object.first_triangle + object.triangles; ++t)
    for (int v : mesh.triangles[static_cast<std::size_t>(t)]) found.insert(v);
  return {found.begin(), found.end()};
}

std::vector<int> row_at(const RecordedMesh& mesh, Real along) {
  std::vector<int> of_strip, row;
  const auto strip = std::ranges::find(mesh.objects, true, &cosim::RecordedObject::strip);
  if (strip != mesh.objects.end()) of_strip = vertices_of(mesh, *strip);
  const auto off = [&](int v) { return std::fabs(mesh.rest[static_cast<std::size_t>(v)].x() - along); };
  Real nearest = std::numeric_limits<Real>::infinity();
  for (int v : of_strip) nearest = std::min(nearest, off(v));
  for (int v : of_strip)
    if (off(v) < nearest + 1e-9) row.push_back(v);
  return row;
}

Vec3 place_of(const std::string& name, const RecordedMesh& mesh, const RecordedFrame& frame) {
  const std::vector<int> vertices = vertices_named(mesh, name);
  const std::vector<Vec3> x = vertex_positions(mesh, frame);
  Vec3 sum = Vec3::Zero();
  for (int v : vertices) sum += x[static_cast<std::size_t>(v)];
  return sum / static_cast<Real>(vertices.size());
}

Pose frame_of(const std::string& name, const RecordedMesh& mesh, const RecordedFrame& frame) {
  std::size_t body = 0;
  for (const cosim::RecordedObject& object : mesh.objects) {
    if (object.strip) continue;
    if (object.name == name) return frame.bodies[body];
    ++body;
  }
  if (const auto found = find_link(name, mesh)) return cosim::to_tape(frame.robots[found->robot].links[found->link]);
  throw InputError("camera.mount = " + name + ": no body and no link robot:link has this name");
}

std::vector<std::string> bearers_of(const RecordedMesh& mesh) {
  std::vector<std::string> names = mesh.grips;
  for (const cosim::RecordedRobot& robot : mesh.robots)
    for (const std::string& link : robot.links) names.push_back(robot.name + ":" + link);
  return names;
}

Real force_on(const std::string& bearer, const RecordedMesh& mesh, const RecordedFrame& frame) {
  if (const auto grip = std::ranges::find(mesh.grips, bearer); grip != mesh.grips.end())
    return frame.grip_force[static_cast<std::size_t>(grip - mesh.grips.begin())].norm();
  const auto link = find_link(bearer, mesh);
  TAPE_CHECK(link);  // the names have been checked
  return frame.robots[link->robot].wrench[link->link].head<3>().norm();
}
}  // namespace tape::movie
