#include "tape/contact/containment.hpp"

#include <cmath>
#include <numbers>

#include "tape/core/error.hpp"

namespace tape {
namespace {
/// Solid angle [sr] of triangle a b c seen from the origin, signed [Van Oosterom 1983].
Real solid_angle(const Vec3& a, const Vec3& b, const Vec3& c) {
  const Real la = a.norm(), lb = b.norm(), lc = c.norm();
  return 2 * std::atan2(a.dot(b.cross(c)), la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb);
}
}  // namespace

void check_nothing_inside(const std::vector<Vec3>& x, const SurfaceMesh& mesh) {
  const std::size_t objects = mesh.objects.size();
  std::vector<std::vector<const SurfaceTriangle*>> triangles(objects);
  std::vector<int> vertex(objects, -1);
  const auto object_of = [&](int v) { return static_cast<std::size_t>(mesh.vertices[static_cast<std::size_t>(v)].object); };
  for (const SurfaceTriangle& t : mesh.triangles) {
    triangles[object_of(t.v[0])].push_back(&t);
    vertex[object_of(t.v[0])] = t.v[0];
  }
  for (std::size_t inner = 0; inner < objects; ++inner) {
    for (std::size_t outer = 0; outer < objects; ++outer) {
      if (inner == outer || vertex[inner] < 0 || vertex[outer] < 0 || triangles[outer][0]->open) continue;
      if (mesh.kept_apart(static_cast<int>(inner), static_cast<int>(outer))) continue;
      const Vec3& p = x[static_cast<std::size_t>(vertex[inner])];
      Real angle = 0;
      for (const SurfaceTriangle* t : triangles[outer])
        angle += solid_angle(x[static_cast<std::size_t>(t->v[0])] - p, x[static_cast<std::size_t>(t->v[1])] - p,
                             x[static_cast<std::size_t>(t->v[2])] - p);
      if (std::fabs(angle) > 3 * std::numbers::pi)
        throw InputError("'" + mesh.objects[inner] + "' starts inside '" + mesh.objects[outer] + "'");
    }
  }
}
}  // namespace tape
