#include "tape/model/mass_properties.hpp"

#include <numbers>

namespace tape {
MassProperties mass_properties(const TriangleMesh& mesh) {
  MassProperties m;
  if (mesh.vertices.empty()) return m;
  Vec3 low = mesh.vertices[0], high = low;
  for (const Vec3& v : mesh.vertices) low = low.cwiseMin(v), high = high.cwiseMax(v);
  const Vec3 origin = (low + high) / 2;  // far from it the tetrahedra would cancel
  Vec3 first = Vec3::Zero();
  for (const Index3& t : mesh.triangles) {
    const Vec3 a = mesh.vertices[t[0]] - origin, b = mesh.vertices[t[1]] - origin, c = mesh.vertices[t[2]] - origin;
    const Vec3 sum = a + b + c;
    const Real volume = a.dot(b.cross(c)) / 6;
    m.volume += volume;
    first += volume / 4 * sum;
    // Tetrahedron (0, a, b, c): the integral of y y^T is V/20 (sum of v v^T over its corners + s s^T), s the sum of its corners.
    m.second += volume / 20 * (a * a.transpose() + b * b.transpose() + c * c.transpose() + sum * sum.transpose());
  }
  if (m.volume == 0) return m;
  const Vec3 offset = first / m.volume;
  m.centre = origin + offset;
  m.second -= m.volume * offset * offset.transpose();
  return m;
}

MassProperties ring_properties(Real inner_radius, Real outer_radius, Real height) {
  const Real inner2 = inner_radius * inner_radius, outer2 = outer_radius * outer_radius;
  MassProperties m;
  m.volume = std::numbers::pi * (outer2 - inner2) * height;
  m.second.diagonal() = m.volume * Vec3((inner2 + outer2) / 4, (inner2 + outer2) / 4, height * height / 12);
  return m;
}
}  // namespace tape
