#pragma once
#include <cmath>

#include "tape/core/types.hpp"

namespace tape {
/// Matrix of the cross product: skew(w) r = w x r.
TAPE_HD inline Mat3 skew(const Vec3& w) {
  Mat3 m;
  m << 0, -w.z(), w.y(), w.z(), 0, -w.x(), -w.y(), w.x(), 0;
  return m;
}
/// Axial vector of a matrix: axial(skew(w)) = 2 w; zero for symmetric matrices.
TAPE_HD inline Vec3 axial(const Mat3& m) { return {m(2, 1) - m(1, 2), m(0, 2) - m(2, 0), m(1, 0) - m(0, 1)}; }

/// Rotation by the vector w [rad]: exp(skew(w)) (Rodrigues). Accurate at w = 0 too.
TAPE_HD inline Mat3 rotation_exp(const Vec3& w) {
  const Real angle2 = w.squaredNorm(), angle = std::sqrt(angle2);
  const Real half_sine = std::sin(angle / 2);
  const Real a = angle > 1e-4 ? std::sin(angle) / angle : 1 - angle2 / 6;
  const Real b = angle > 1e-4 ? 2 * half_sine * half_sine / angle2 : 0.5 - angle2 / 24;
  const Mat3 k = skew(w);
  return Mat3::Identity() + a * k + b * k * k;
}
/// exp(skew(w)) r without forming the matrix.
TAPE_HD inline Vec3 rotate(const Vec3& w, const Vec3& r) {
  const Real angle2 = w.squaredNorm(), angle = std::sqrt(angle2);
  const Real half_sine = std::sin(angle / 2);
  const Real a = angle > 1e-4 ? std::sin(angle) / angle : 1 - angle2 / 6;
  const Real b = angle > 1e-4 ? 2 * half_sine * half_sine / angle2 : 0.5 - angle2 / 24;
  const Vec3 wr = w.cross(r);
  return r + a * wr + b * w.cross(wr);
}
/// Rotation vector w [rad], |w| <= pi, with exp(skew(w)) = R.
inline Vec3 rotation_log(const Mat3& R) {
  const Eigen::Quaternion<Real> q{R};  // not AngleAxis: it calls a host function, which nvcc does not let pass in what kernels include
  const Real n = q.vec().norm();       // |sin(angle/2)|
  if (n == 0) return Vec3::Zero();
  return 2 * std::atan2(n, std::fabs(q.w())) * (q.vec() / (q.w() < 0 ? -n : n));
}
/// Largest distance [m] of a point on an arc of `angle` [rad] and radius r [m] from the arc's chord: r (1 - cos(angle/2)),
/// and 2 r at most, beyond a full turn.
TAPE_HD inline Real chord_deviation(Real radius, Real angle) {
  constexpr Real kPi = 3.14159265358979323846;
  const Real half = std::fmin(std::fabs(angle) / 2, kPi), s = std::sin(half / 2);
  return 2 * radius * s * s;
}
}  // namespace tape
