#pragma once
#include <cmath>

#include "tape/core/types.hpp"
#include "tape/math/rotation.hpp"

namespace tape {
/// Angle [rad] in (-pi, pi] between the normals of triangles x[0] x[1] x[2] and x[1] x[0] x[3] with its gradient [rad/m].
/// Zero when flat; positive where x[3] lies above the first triangle, whose normal is (x[1]-x[0]) x (x[2]-x[0]).
struct Dihedral {
  Real angle;
  Vec3 gradient[4];
};

namespace detail {
/// One of the two triangles at the edge e = x[1] - x[0]: how the angle moves with its apex (up to sign), and the place t of the
/// apex's foot along the edge.
struct Wing {
  Vec3 normal;  ///< [m^2] e x arm, twice the area
  Vec3 g;       ///< [1/m] |e| normal / |normal|^2
  Real t;       ///< [1]
};
TAPE_HD inline Wing wing(const Vec3& e, const Vec3& arm) {
  const Vec3 n = e.cross(arm);
  return {n, e.norm() / n.squaredNorm() * n, arm.dot(e) / e.squaredNorm()};
}
/// Derivatives of g and t by e and by the arm.
struct WingSlope {
  Mat3 g_e, g_arm;
  Vec3 t_e, t_arm;
};
TAPE_HD inline WingSlope wing_slope(const Vec3& e, const Vec3& arm, const Wing& w) {
  const Real length2 = e.squaredNorm(), length = std::sqrt(length2), n2 = w.normal.squaredNorm();
  const Mat3 g_n = length / n2 * (Mat3::Identity() - 2 / n2 * w.normal * w.normal.transpose());
  return {-g_n * skew(arm) + w.normal * e.transpose() / (n2 * length), g_n * skew(e), (arm - 2 * w.t * e) / length2, e / length2};
}
}  // namespace detail

/// Gradient as in [Grinspun 2003]: the apexes move along the normals, the ends of the edge balance force and torque.
TAPE_HD inline Dihedral dihedral(const Vec3 (&x)[4]) {
  const Vec3 e = x[1] - x[0];
  const detail::Wing a = detail::wing(e, x[2] - x[0]), b = detail::wing(e, x[3] - x[0]);
  const Real sine = a.normal.cross(b.normal).dot(e) / e.norm(), cosine = -a.normal.dot(b.normal);
  return {std::atan2(sine, cosine), {(1 - b.t) * b.g - (1 - a.t) * a.g, b.t * b.g - a.t * a.g, a.g, -b.g}};
}

/// Second derivative [rad/m^2] of the angle by x[0] ... x[3].
TAPE_HD inline MatN<12, 12> dihedral_hessian(const Vec3 (&x)[4]) {
  const Vec3 e = x[1] - x[0];
  MatN<9, 9> h = MatN<9, 9>::Zero();  // by e, x[2] - x[0], x[3] - x[0]
  for (int k = 1; k <= 2; ++k) {
    // The gradient by the arm is g, that by e is -t g: the angle does not change when apex and edge turn together.
    const Vec3 arm = x[k + 1] - x[0];
    const Real sign = k == 1 ? 1 : -1;
    const detail::Wing w = detail::wing(e, arm);
    const detail::WingSlope s = detail::wing_slope(e, arm, w);
    h.block<3, 3>(3 * k, 3 * k) = sign * s.g_arm;
    h.block<3, 3>(3 * k, 0) = sign * s.g_e;
    h.block<3, 3>(0, 3 * k) = sign * s.g_e.transpose();
    h.block<3, 3>(0, 0) -= sign * (w.t * s.g_e + w.g * s.t_e.transpose());
  }
  MatN<12, 12> full;
  full.bottomRightCorner<9, 9>() = h;
  full.topRightCorner<3, 9>() = -(h.topRows<3>() + h.middleRows<3>(3) + h.bottomRows<3>());
  full.bottomLeftCorner<9, 3>() = full.topRightCorner<3, 9>().transpose();
  full.topLeftCorner<3, 3>() = -(full.block<3, 3>(0, 3) + full.block<3, 3>(0, 6) + full.block<3, 3>(0, 9));
  return full;
}
}  // namespace tape
