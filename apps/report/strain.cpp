#include "apps/report/strain.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>

namespace tape::report {
Real largest_strain(const Vec2 (&rest)[3], const Vec3 (&x)[3]) {
  Mat2 from;
  Mat32 to;
  from << rest[1] - rest[0], rest[2] - rest[0];
  to << x[1] - x[0], x[2] - x[0];
  const Mat32 F = to * from.inverse();
  const Mat2 E = 0.5 * (F.transpose() * F - Mat2::Identity());
  const Real mean = E.trace() / 2, radius = std::hypot((E(0, 0) - E(1, 1)) / 2, E(0, 1));
  return std::abs(mean) + radius;
}

std::vector<Real> vertex_strain(const std::vector<Index3>& triangles, const std::vector<Vec2>& rest, const std::vector<Vec3>& x,
                                int strip_vertices) {
  std::vector<Real> strain(x.size(), std::numeric_limits<Real>::quiet_NaN());
  std::fill(strain.begin(), strain.begin() + strip_vertices, 0);
  const auto at = [](int v) { return static_cast<std::size_t>(v); };
  for (const Index3& t : triangles) {
    if (t.maxCoeff() >= strip_vertices) continue;
    const Real value = largest_strain({rest[at(t[0])], rest[at(t[1])], rest[at(t[2])]}, {x[at(t[0])], x[at(t[1])], x[at(t[2])]});
    for (int v : t) strain[at(v)] = std::max(strain[at(v)], value);
  }
  return strain;
}
}  // namespace tape::report
