#include "apps/report/strain.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>

namespace tape::report {
namespace {
/// (F^T F - I)/2.
Mat2 green_strain(const Vec2 (&rest)[3], const Vec3 (&x)[3]) {
  Mat2 from;
  Mat32 to;
  from << rest[1] - rest[0], rest[2] - rest[0];
  to << x[1] - x[0], x[2] - x[0];
  const Mat32 F = to * from.inverse();
  return 0.5 * (F.transpose() * F - Mat2::Identity());
}
/// Half the difference of the eigenvalues of a symmetric matrix.
Real deviator(const Mat2& m) { return std::hypot((m(0, 0) - m(1, 1)) / 2, m(0, 1)); }

/// Per vertex the largest value of its triangles. @param value  of a triangle's index, rest corners and corners
template <class F>
std::vector<Real> vertex_values(const std::vector<Index3>& triangles, const std::vector<Vec2>& rest, const std::vector<Vec3>& x,
                                int strip_vertices, const F& value) {
  std::vector<Real> out(x.size(), std::numeric_limits<Real>::quiet_NaN());
  std::fill(out.begin(), out.begin() + strip_vertices, 0);
  const auto at = [](int v) { return static_cast<std::size_t>(v); };
  for (std::size_t k = 0; k < triangles.size(); ++k) {
    const Index3& t = triangles[k];
    if (t.maxCoeff() >= strip_vertices) continue;
    const Vec2 flat[3] = {rest[at(t[0])], rest[at(t[1])], rest[at(t[2])]};
    const Vec3 moved[3] = {x[at(t[0])], x[at(t[1])], x[at(t[2])]};
    const Real of_triangle = value(k, flat, moved);
    for (int v : t) out[at(v)] = std::max(out[at(v)], of_triangle);
  }
  return out;
}
}  // namespace

Real largest_strain(const Vec2 (&rest)[3], const Vec3 (&x)[3]) {
  const Mat2 E = green_strain(rest, x);
  return std::abs(E.trace() / 2) + deviator(E);
}

Real largest_tension(const Vec2 (&rest)[3], const Vec3 (&x)[3], const FilmStiffness& film) {
  const Mat2 E = green_strain(rest, x);
  const Mat2 S = film.stretch * ((1 - film.poisson) * E + film.poisson * E.trace() * Mat2::Identity());
  return S.trace() / 2 + deviator(S);
}

std::vector<Real> vertex_strain(const std::vector<Index3>& triangles, const std::vector<Vec2>& rest, const std::vector<Vec3>& x,
                                int strip_vertices) {
  return vertex_values(triangles, rest, x, strip_vertices,
                       [](std::size_t, const Vec2(&flat)[3], const Vec3(&moved)[3]) { return largest_strain(flat, moved); });
}

std::vector<Real> vertex_tension(const std::vector<Index3>& triangles, const std::vector<Vec2>& rest, const std::vector<Vec3>& x,
                                 int strip_vertices, const std::vector<FilmStiffness>& film) {
  return vertex_values(triangles, rest, x, strip_vertices,
                       [&](std::size_t t, const Vec2(&flat)[3], const Vec3(&moved)[3]) { return largest_tension(flat, moved, film[t]); });
}
}  // namespace tape::report
