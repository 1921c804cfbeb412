#pragma once
#include <cmath>

#include "tape/effects/body_inertia.hpp"
#include "tape/math/psd.hpp"
#include "tape/math/rotation.hpp"

namespace tape {
TAPE_HD Real BodyQuadratic::energy(const Pose& at, const Pose& target) const {
  const Mat3 dR = at.rotation - target.rotation;
  return mass / 2 * (at.position - target.position).squaredNorm() + (dR * second).cwiseProduct(dR).sum() / 2;
}
TAPE_HD VecN<6> BodyQuadratic::gradient(const Pose& at, const Pose& target) const {
  VecN<6> g;
  g.head<3>() = mass * (at.position - target.position);
  g.tail<3>() = axial(at.rotation * second * target.rotation.transpose());
  return g;
}
TAPE_HD MatN<6, 6> BodyQuadratic::hessian(const Pose& at, const Pose& target, HessianMode mode) const {
  constexpr Real kLeast = 0.1;  // share of the bound below which there is too little curvature to step by
  const auto turning = [](const Mat3& M) { return Mat3(M.trace() * Mat3::Identity() - 0.5 * (M + M.transpose())); };
  Mat3 turn = turning(at.rotation * second * target.rotation.transpose());
  if (mode == HessianMode::projected) {
    const Mat3 bound =
        0.5 * turning(at.rotation * second * at.rotation.transpose() + target.rotation * second * target.rotation.transpose());
    const SymmetricEigen<3> above = symmetric_eigen(turn - kLeast * bound);
    if (std::fmin(above.value[0], std::fmin(above.value[1], above.value[2])) < 0) turn = bound;
  }
  MatN<6, 6> h = MatN<6, 6>::Zero();
  h.topLeftCorner<3, 3>() = mass * Mat3::Identity();
  h.bottomRightCorner<3, 3>() = turn;
  return h;
}
TAPE_HD Real BodyInertia::energy(const StateView& s, int i) const {
  const Element& e = elements[i];
  return quadratic(s, e).energy(s.body[e.body], s.body_target[e.body]) / (s.dt * s.dt);
}
TAPE_HD VecN<6> BodyInertia::gradient(const StateView& s, int i) const {
  const Element& e = elements[i];
  return quadratic(s, e).gradient(s.body[e.body], s.body_target[e.body]) / (s.dt * s.dt);
}
TAPE_HD MatN<6, 6> BodyInertia::hessian(const StateView& s, int i, HessianMode mode) const {
  const Element& e = elements[i];
  return quadratic(s, e).hessian(s.body[e.body], s.body_target[e.body], mode) / (s.dt * s.dt);
}
TAPE_HD BodyQuadratic BodyInertia::quadratic(const StateView& s, const Element& e) {
  return {s.body_mass[e.body].mass, s.body_mass[e.body].second};
}
}  // namespace tape
