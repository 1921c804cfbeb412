#pragma once
#include <vector>

#include "tape/cutting/kerf.hpp"

namespace tape {
/// Values of the new vertices, from those of the old ones by the places of their parents.
template <class T>
std::vector<T> interpolated(const StripMesh& old, const Cut& cut, const std::vector<T>& value) {
  std::vector<T> out;
  out.reserve(cut.parent.size());
  for (const Place& p : cut.parent) {
    const Index3& v = old.triangles[p.triangle];
    out.push_back(p.weight[0] * value[v[0]] + p.weight[1] * value[v[1]] + p.weight[2] * value[v[2]]);
  }
  return out;
}

/// A third of the rest area of the triangles around each vertex times `per_area` [kg/m^2].
std::vector<Real> lumped_mass(const StripMesh& mesh, Real per_area);

/// Linear and angular momentum (about the origin), and mass.
struct Momentum {
  Real mass = 0;                ///< [kg]
  Vec3 linear = Vec3::Zero();   ///< [kg m/s]
  Vec3 angular = Vec3::Zero();  ///< [kg m^2/s]
  void add(Real m, const Vec3& x, const Vec3& v) { mass += m, linear += m * v, angular += m * x.cross(v); }
  /// An even triangle of mass m whose corners are at x and move by v; positions and velocities are linear in between.
  void add_triangle(Real m, const Mat3& x, const Mat3& v);
};
Momentum momentum(const std::vector<Real>& mass, const std::vector<Vec3>& x, const std::vector<Vec3>& v);

/// The motion of a strip after a cut.
struct MovedOn {
  std::vector<Vec3> x, v;   ///< [vertices] m, m/s
  std::vector<Real> mass;   ///< [vertices] kg, lumped
  Momentum kerf;            ///< of the removed material: integrals of the old linear positions and velocities over it
  Real largest_change = 0;  ///< [m/s] of a vertex, by the motions that restore momentum
};
/// Interpolates positions and velocities, and restores the momentum: that of the lumped masses was, and with `kerf` is again, the same.
/// 1. Each piece gets the rigid motion of least kinetic energy that makes up for what interpolation did: the integrals of v and x cross v
///    over its new triangles are those of the old ones there.
/// 2. Lumping anew moves mass between the corners. The angular momentum that this gives or takes is restored by one spin, the same for all
///    pieces that were cut, each about its own centre.
/// Pieces without new triangles stay as they are, to the bit.
/// @param x, v      [old vertices] m, m/s
/// @param per_area  [kg/m^2]
MovedOn move_on(const StripMesh& old, const Cut& cut, const std::vector<Vec3>& x, const std::vector<Vec3>& v, Real per_area);

/// Where a point of the old strip is in the new one. Its triangle is -1 if the point went with the kerf.
Place new_place(const StripMesh& old, const Cut& cut, const Place& place);
}  // namespace tape
