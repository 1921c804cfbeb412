#pragma once
#include "tape/core/types.hpp"

namespace tape {
/// A point that moves with some of K vertices, seen from a material point of the triangle that the last three of them make: the way
/// between the two, and its components along the triangle's edges. A rigid motion leaves the components alone.
template <int K>
struct TrianglePlane {
  Vec3 e[2];  ///< [m] edges of the triangle
  Vec3 r;     ///< [m] = sum w_i x_i, from the triangle's point to the other
  Real w[K];

  /// @param x     [K] m
  /// @param foot  [1] barycentric coordinates of the material point
  TAPE_HD TrianglePlane(const Vec3 (&x)[K], const Real (&weight)[K - 3], const Real (&foot)[3]) {
    for (int i = 0; i < K; ++i) w[i] = i < K - 3 ? weight[i] : -foot[i - (K - 3)];
    e[0] = x[K - 2] - x[K - 3], e[1] = x[K - 1] - x[K - 3];
    r = Vec3::Zero();
    for (int i = 1; i < K; ++i) r += w[i] * (x[i] - x[0]);  // the weights sum to 0; differences keep the digits of a small way
  }
  /// Covariant components e_a.r [m^2].
  TAPE_HD Vec2 along() const { return {e[0].dot(r), e[1].dot(r)}; }
  /// e_a.e_b [m^2].
  TAPE_HD Mat2 metric() const {
    Mat2 g;
    g << e[0].squaredNorm(), e[0].dot(e[1]), e[0].dot(e[1]), e[1].squaredNorm();
    return g;
  }
  /// d along/dx [m].
  TAPE_HD MatN<3 * K, 2> slope() const {
    MatN<3 * K, 2> J;
    for (int i = 0; i < K; ++i)
      for (int a = 0; a < 2; ++a) J.template block<3, 1>(3 * i, a) = w[i] * e[a] + edge_weight(a, i) * r;
    return J;
  }
  /// h += sum_a y_a d2 along_a/dx2.
  TAPE_HD void add_curvature(const Vec2& y, MatN<3 * K, 3 * K>& h) const {
    for (int i = 0; i < K; ++i)
      for (int j = 0; j < K; ++j)
        for (int a = 0; a < 2; ++a)
          h.template block<3, 3>(3 * i, 3 * j).diagonal().array() += y[a] * (edge_weight(a, i) * w[j] + w[i] * edge_weight(a, j));
  }

 private:
  /// Of vertex i in edge a.
  TAPE_HD static Real edge_weight(int a, int i) { return i == K - 3 ? -1.0 : i == K - 2 + a ? 1.0 : 0.0; }
};
}  // namespace tape
