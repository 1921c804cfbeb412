#include "cosim/exchange/proxy.hpp"

#include <algorithm>
#include <map>

#include "robot/model/convex_hull.hpp"
#include "tape/core/error.hpp"
#include "tape/model/mesh_check.hpp"
#include "tape/model/primitives.hpp"

namespace cosim {
namespace {
using robot::Vec3;
constexpr std::size_t kFew = 500;  // triangles

tape::TriangleMesh in_link(const robot::TriangleMesh& mesh, const robot::Pose& X_LS) {
  tape::TriangleMesh out;
  for (const Vec3& p : mesh.vertices) out.vertices.push_back(X_LS * p);
  for (const auto& t : mesh.triangles) out.triangles.emplace_back(t[0], t[1], t[2]);
  return out;
}

bool is_closed(const tape::TriangleMesh& mesh) {
  try {
    check_mesh(mesh, "", true);
    return true;
  } catch (const tape::InputError&) {
    return false;
  }
}

robot::TriangleMesh surround(const robot::TriangleMesh& hull) {
  static const std::vector<Vec3> directions = tape::sphere_mesh(1, 2).vertices;
  std::map<std::size_t, bool> farthest;
  for (const Vec3& d : directions) {
    const auto by = [&](const Vec3& a, const Vec3& b) { return a.dot(d) < b.dot(d); };
    farthest[static_cast<std::size_t>(std::ranges::max_element(hull.vertices, by) - hull.vertices.begin())] = true;
  }
  std::vector<Vec3> points;
  for (const auto& [i, is] : farthest) points.push_back(hull.vertices[i]);
  return robot::convex_hull(points);
}

/// How far outside a convex surface the farthest of these points is.
double excess(const std::vector<Vec3>& points, const robot::TriangleMesh& convex) {
  double most = 0;
  for (const Vec3& p : points) {
    double outside = 0;
    for (const auto& t : convex.triangles) {
      const Vec3& a = convex.vertices[static_cast<std::size_t>(t[0])];
      const Vec3 n = (convex.vertices[static_cast<std::size_t>(t[1])] - a).cross(convex.vertices[static_cast<std::size_t>(t[2])] - a);
      outside = std::max(outside, n.normalized().dot(p - a));
    }
    most = std::max(most, outside);
  }
  return most;
}
}  // namespace

Proxy make_proxy(const robot::Link& link) {
  Proxy proxy;
  for (const robot::Shape& shape : link.collision) {
    tape::TriangleMesh part = in_link(shape.mesh, shape.X_LS);
    if (part.triangles.size() > kFew || !is_closed(part)) {
      const robot::TriangleMesh hull = robot::convex_hull(shape.mesh.vertices, robot::hull_cache()), around = surround(hull);
      proxy.error = std::max(proxy.error, excess(hull.vertices, around));
      part = in_link(around, shape.X_LS);
    }
    const int first = static_cast<int>(proxy.mesh.vertices.size());
    proxy.mesh.vertices.insert(proxy.mesh.vertices.end(), part.vertices.begin(), part.vertices.end());
    for (const tape::Index3& t : part.triangles) proxy.mesh.triangles.emplace_back(t.array() + first);
  }
  return proxy;
}
}  // namespace cosim
