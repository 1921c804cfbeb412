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
/// A link, or a frame that is fixed in it.
struct Place {
  std::size_t robot, link;
  robot::Pose X_LF = robot::Pose::Identity();
};
std::optional<Place> find_link(const std::string& name, const RecordedMesh& mesh) {
  for (std::size_t r = 0; r < mesh.robots.size(); ++r) {
    const cosim::RecordedRobot& robot = mesh.robots[r];
    for (std::size_t l = 0; l < robot.links.size(); ++l)
      if (robot.name + ":" + robot.links[l] == name) return Place{r, l};
    for (const robot::Frame& frame : robot.frames)
      if (robot.name + ":" + frame.name == name) return Place{r, static_cast<std::size_t>(frame.link), frame.X_LF};
  }
  return {};
}

std::optional<std::size_t> find_body(const std::string& name, const RecordedMesh& mesh) {
  std::size_t body = 0;
  for (const cosim::RecordedObject& object : mesh.objects) {
    if (object.strip) continue;
    if (object.name == name) return body;
    ++body;
  }
  return {};
}

[[noreturn]] void refuse_mount(const std::string& name) {
  throw InputError("mount = " + name + ": no body and no link or frame robot:link has this name");
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
  throw InputError("follow = " + name + ": no thing of the scene has this name (allowed: " + names + ")");
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
  if (const auto body = find_body(name, mesh)) return frame.bodies[*body];
  if (const auto found = find_link(name, mesh)) return cosim::to_tape(frame.robots[found->robot].links[found->link] * found->X_LF);
  refuse_mount(name);
}

void require_things(const std::vector<CameraParams>& cameras, const RecordedMesh& mesh) {
  for (const CameraParams& camera : cameras) {
    const std::string mount = std::visit([](const auto& lens) { return lens.mount; }, camera.lens);
    if (!mount.empty() && !find_body(mount, mesh) && !find_link(mount, mesh)) refuse_mount(mount);
    const auto* look = std::get_if<render::LookAtSettings>(&camera.lens);
    if (look && !look->follow.empty()) vertices_named(mesh, look->follow);
  }
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
