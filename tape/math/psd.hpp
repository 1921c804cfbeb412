#pragma once
#include <cmath>

#include "tape/core/types.hpp"

namespace tape {
/// Eigenvalues and unit eigenvectors of a symmetric matrix: m = sum_k value[k] vector_k vector_k^T, vectors as columns.
template <int N>
struct SymmetricEigen {
  Real value[N];
  MatN<N, N> vectors;
};

/// Eigen-decomposition of a symmetric 3x3 matrix by Jacobi rotations. Errors are of the order of round-off times |m|.
TAPE_HD inline SymmetricEigen<3> symmetric_eigen(const Mat3& m) {
  Mat3 a = m, v = Mat3::Identity();
  for (int rotation = 0; rotation < 18; ++rotation) {  // six sweeps: convergence is quadratic, three or four are enough
    const int p = rotation % 3 == 2 ? 1 : 0, q = rotation % 3 == 0 ? 1 : 2;
    if (a(p, q) == 0) continue;
    const Real ratio = (a(q, q) - a(p, p)) / (2 * a(p, q));
    const Real t = (ratio >= 0 ? 1 : -1) / (std::fabs(ratio) + std::sqrt(1 + ratio * ratio));
    const Real c = 1 / std::sqrt(1 + t * t), s = t * c;
    const int r = 3 - p - q;
    const Real apq = a(p, q), arp = a(r, p), arq = a(r, q);
    a(p, p) -= t * apq, a(q, q) += t * apq;
    a(p, q) = a(q, p) = 0;
    a(r, p) = a(p, r) = c * arp - s * arq;
    a(r, q) = a(q, r) = s * arp + c * arq;
    const Vec3 vp = v.col(p), vq = v.col(q);
    v.col(p) = c * vp - s * vq;
    v.col(q) = s * vp + c * vq;
  }
  return {{a(0, 0), a(1, 1), a(2, 2)}, v};
}

/// Closest positive semidefinite matrix to a symmetric one: its negative eigenvalues become zero.
TAPE_HD inline Mat2 psd_part(const Mat2& m) {
  const Real mean = (m(0, 0) + m(1, 1)) / 2, half = (m(0, 0) - m(1, 1)) / 2, off = m(0, 1);
  const Real radius = std::sqrt(half * half + off * off), low = mean - radius, high = mean + radius;
  if (low >= 0) return m;
  if (high <= 0) return Mat2::Zero();
  return high / (high - low) * (m - low * Mat2::Identity());
}
TAPE_HD inline Mat3 psd_part(const Mat3& m) {
  const SymmetricEigen<3> e = symmetric_eigen(m);
  if (e.value[0] >= 0 && e.value[1] >= 0 && e.value[2] >= 0) return m;
  Mat3 sum = Mat3::Zero();
  for (int k = 0; k < 3; ++k)
    if (e.value[k] > 0) sum += e.value[k] * e.vectors.col(k) * e.vectors.col(k).transpose();
  return sum;
}
}  // namespace tape
