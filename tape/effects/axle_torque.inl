#pragma once
#include <cmath>

#include "tape/effects/axle_torque.hpp"

namespace tape {
/// The angle phi as a function of the five markers.
struct AxleTorque::Turn {
  Vec3 a, d, b;
  Real s, c;
  TAPE_HD Turn(const Element& e, Span<const Vec3> x)
      : a(x[e.v[1]] - x[e.v[0]]), d(x[e.v[3]] - x[e.v[2]]), b(x[e.v[4]] - x[e.v[2]]), s(a.dot(b)), c(a.dot(d)) {}
  TAPE_HD static Real in_a(int k) { return k == 1 ? 1 : k == 0 ? -1 : 0; }
  TAPE_HD static Real in_d(int k) { return k == 3 ? 1 : k == 2 ? -1 : 0; }
  TAPE_HD static Real in_b(int k) { return k == 4 ? 1 : k == 2 ? -1 : 0; }
  TAPE_HD VecN<15> slope_of_s() const {
    VecN<15> g;
    for (int k = 0; k < 5; ++k) g.segment<3>(3 * k) = in_a(k) * b + in_b(k) * a;
    return g;
  }
  TAPE_HD VecN<15> slope_of_c() const {
    VecN<15> g;
    for (int k = 0; k < 5; ++k) g.segment<3>(3 * k) = in_a(k) * d + in_d(k) * a;
    return g;
  }
  TAPE_HD VecN<15> slope() const { return (c * slope_of_s() - s * slope_of_c()) / (s * s + c * c); }
  TAPE_HD MatN<15, 15> curvature() const {
    const VecN<15> gs = slope_of_s(), gc = slope_of_c();
    const Real r2 = s * s + c * c;
    const MatN<15, 15> mixed = gs * gc.transpose();
    MatN<15, 15> h = (2 * s * c * (gc * gc.transpose() - gs * gs.transpose()) + (s * s - c * c) * (mixed + mixed.transpose())) / (r2 * r2);
    for (int k = 0; k < 5; ++k)
      for (int l = 0; l < 5; ++l) {
        const Real of_s = in_a(k) * in_b(l) + in_b(k) * in_a(l), of_c = in_a(k) * in_d(l) + in_d(k) * in_a(l);
        h.block<3, 3>(3 * k, 3 * l) += (c * of_s - s * of_c) / r2 * Mat3::Identity();
      }
    return h;
  }
};

TAPE_HD Real AxleTorque::slip(const StateView& s, int i) const {
  const Turn now(elements[i], s.x), start(elements[i], s.x_start);
  const Real asked = std::atan2(start.s, start.c) + elements[i].speed * s.dt;
  return std::atan2(now.s * std::cos(asked) - now.c * std::sin(asked), now.c * std::cos(asked) + now.s * std::sin(asked));
}
TAPE_HD Real AxleTorque::torque(const StateView& s, int i) const {
  const Real y = slip(s, i);
  return -elements[i].torque * law(s).secant(std::fabs(y)) * y;
}
TAPE_HD Real AxleTorque::energy(const StateView& s, int i) const { return elements[i].torque * law(s).value(std::fabs(slip(s, i))); }
TAPE_HD VecN<15> AxleTorque::gradient(const StateView& s, int i) const { return -torque(s, i) * Turn(elements[i], s.x).slope(); }
TAPE_HD MatN<15, 15> AxleTorque::hessian(const StateView& s, int i, HessianMode mode) const {
  const Turn turn(elements[i], s.x);
  const VecN<15> J = turn.slope();
  const Real y = std::fabs(slip(s, i)), stiffness = law(s).secant(y) - (s.overshot ? 0 : law(s).bend(y));
  MatN<15, 15> h = elements[i].torque * stiffness * J * J.transpose();
  if (mode == HessianMode::projected || s.overshot) return h;
  h -= torque(s, i) * turn.curvature();
  return h;
}
}  // namespace tape
