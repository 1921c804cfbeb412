#include "cosim/exchange/proxy.hpp"

#include <algorithm>
#include <map>
#include <optional>

#include "cosim/run/cache_folder.hpp"
#include "robot/model/convex_hull.hpp"
#include "tape/core/error.hpp"
#include "tape/model/mesh_check.hpp"
#include "tape/model/primitives.hpp"

namespace cosim {
namespace {
using robot::Vec3;
constexpr std::size_t kFew = 500;  // triangles
constexpr double kFlat = 1e-6;     // [m] that corners of a convex mesh may stand out of it
constexpr double kFilled = 1e-4;   // [m] that one hull of several shapes may stand out of them

tape::TriangleMesh to_tape(const robot::TriangleMesh& mesh) {
  tape::TriangleMesh out{.vertices = mesh.vertices, .triangles = {}};
  for (const auto& t : mesh.triangles) out.triangles.emplace_back(t[0], t[1], t[2]);
  return out;
}

bool is_closed(const robot::TriangleMesh& mesh) {
  try {
    check_mesh(to_tape(mesh), "", true);
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

/// Whether a point is outside of a convex surface by no more than a distance [m].
bool is_near(const Vec3& p, const robot::TriangleMesh& convex, double distance) {
  return std::ranges::none_of(convex.triangles, [&](const auto& t) {
    const Vec3& a = convex.vertices[static_cast<std::size_t>(t[0])];
    const Vec3 n = (convex.vertices[static_cast<std::size_t>(t[1])] - a).cross(convex.vertices[static_cast<std::size_t>(t[2])] - a);
    const double outside = n.dot(p - a);
    return outside > 0 && outside * outside > distance * distance * n.squaredNorm();
  });
}

/// The hull of what stands for the shapes of a link, where it fills next to nothing between them, as with a capsule drawn as a cylinder and
/// two spheres.
std::optional<robot::TriangleMesh> common_hull(const std::vector<robot::TriangleMesh>& shapes,
                                               const std::vector<robot::TriangleMesh>& parts) {
  const auto is_convex = [](const robot::TriangleMesh& shape) {
    return is_closed(shape) && std::ranges::all_of(shape.vertices, [&](const Vec3& p) { return is_near(p, shape, kFlat); });
  };
  if (!std::ranges::all_of(shapes, is_convex)) return {};
  std::vector<Vec3> corners;
  for (const robot::TriangleMesh& part : parts) corners.insert(corners.end(), part.vertices.begin(), part.vertices.end());
  robot::TriangleMesh hull = robot::convex_hull(corners);
  const auto on_a_shape = [&](const Vec3& p) {
    return std::ranges::any_of(shapes, [&](const robot::TriangleMesh& shape) { return is_near(p, shape, kFilled); });
  };
  for (const auto& t : hull.triangles) {
    const auto corner = [&](int k) { return hull.vertices[static_cast<std::size_t>(t[k % 3])]; };
    if (!on_a_shape((corner(0) + corner(1) + corner(2)) / 3)) return {};
    for (int k = 0; k < 3; ++k)
      if (!on_a_shape((corner(k) + corner(k + 1)) / 2)) return {};
  }
  return hull;
}
}  // namespace

Proxy make_proxy(const robot::Link& link) {
  Proxy proxy;
  std::vector<robot::TriangleMesh> shapes, parts;
  for (const robot::Shape& shape : link.collision) {
    robot::TriangleMesh& part = parts.emplace_back(shape.mesh);
    if (part.triangles.size() > kFew || !is_closed(part)) {
      const robot::TriangleMesh hull = robot::convex_hull(part.vertices, cache_folder());
      part = surround(hull);
      proxy.error = std::max(proxy.error, excess(hull.vertices, part));
    }
    shapes.push_back(shape.mesh);
    for (Vec3& p : shapes.back().vertices) p = shape.X_LS * p;
    for (Vec3& p : part.vertices) p = shape.X_LS * p;
  }
  if (parts.size() > 1)
    if (auto hull = common_hull(shapes, parts)) parts = {*std::move(hull)};
  for (const robot::TriangleMesh& part : parts) {
    const int first = static_cast<int>(proxy.mesh.vertices.size());
    proxy.mesh.vertices.insert(proxy.mesh.vertices.end(), part.vertices.begin(), part.vertices.end());
    for (const auto& t : part.triangles) proxy.mesh.triangles.emplace_back(t[0] + first, t[1] + first, t[2] + first);
  }
  return proxy;
}
}  // namespace cosim
