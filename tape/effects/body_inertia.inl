#pragma once
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
  const Mat3 M = at.rotation * second * target.rotation.transpose();
  const Mat3 turn = M.trace() * Mat3::Identity() - 0.5 * (M + M.transpose());
  MatN<6, 6> h = MatN<6, 6>::Zero();
  h.topLeftCorner<3, 3>() = mass * Mat3::Identity();
  h.bottomRightCorner<3, 3>() = mode == HessianMode::projected ? psd_part(turn) : turn;
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
