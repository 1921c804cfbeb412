#include "robot/model/primitives.hpp"

#include <cmath>
#include <numbers>

namespace robot {
namespace {
constexpr int kCylinderSegments = 64;  // flats lie inside by 0.12 % of the radius
constexpr int kSphereSegments = 32, kSphereBands = kSphereSegments / 2;

/// A closed surface of revolution about z: rings of vertices from the bottom to the top, closed by a fan to a pole at each end.
/// @param profile  [m] radius and height of each ring, ascending
TriangleMesh revolved(const std::vector<std::pair<Real, Real>>& profile, Real bottom, Real top, int segments) {
  TriangleMesh mesh;
  for (const auto& [radius, z] : profile)
    for (int s = 0; s < segments; ++s) {
      const Real angle = 2 * std::numbers::pi * s / segments;
      mesh.vertices.emplace_back(radius * std::cos(angle), radius * std::sin(angle), z);
    }
  const int rings = static_cast<int>(profile.size()), south = rings * segments, north = south + 1;
  mesh.vertices.emplace_back(0, 0, bottom);
  mesh.vertices.emplace_back(0, 0, top);
  for (int s = 0; s < segments; ++s) {
    const int next = (s + 1) % segments, last = (rings - 1) * segments;
    mesh.triangles.push_back({south, next, s});
    for (int r = 0; r + 1 < rings; ++r) {
      const int a = r * segments + s, b = r * segments + next;
      mesh.triangles.push_back({a, b, b + segments});
      mesh.triangles.push_back({a, b + segments, a + segments});
    }
    mesh.triangles.push_back({north, last + s, last + next});
  }
  return mesh;
}
}  // namespace

Shape box_shape(const Vec3& size, const Pose& X_LS) {
  Shape shape{.kind = Shape::Kind::box, .X_LS = X_LS, .size = size};
  for (int k = 0; k < 8; ++k)  // bit d of k: at which end of axis d
    shape.mesh.vertices.emplace_back(size.cwiseProduct(Vec3(k & 1, k >> 1 & 1, k >> 2) - Vec3::Constant(0.5)));
  shape.mesh.triangles = {{0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}, {0, 1, 5}, {0, 5, 4},
                          {2, 6, 7}, {2, 7, 3}, {0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}};
  return shape;
}

Shape cylinder_shape(Real radius, Real length, const Pose& X_LS) {
  return {.kind = Shape::Kind::cylinder,
          .X_LS = X_LS,
          .size = {radius, radius, length},
          .mesh = revolved({{radius, -length / 2}, {radius, length / 2}}, -length / 2, length / 2, kCylinderSegments)};
}

Shape sphere_shape(Real radius, const Pose& X_LS) {
  std::vector<std::pair<Real, Real>> profile;
  for (int r = 1; r < kSphereBands; ++r) {
    const Real angle = std::numbers::pi * r / kSphereBands;
    profile.emplace_back(radius * std::sin(angle), -radius * std::cos(angle));
  }
  return {.kind = Shape::Kind::sphere,
          .X_LS = X_LS,
          .size = Vec3::Constant(radius),
          .mesh = revolved(profile, -radius, radius, kSphereSegments)};
}
}  // namespace robot
