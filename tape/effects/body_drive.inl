#pragma once
#include "tape/effects/body_drive.hpp"
#include "tape/effects/body_inertia.inl"

namespace tape {
TAPE_HD Real BodyDrive::energy(const StateView& s, int i) const {
  return elements[i].stiffness.energy(s.body[elements[i].body], s.body_target[elements[i].body]);
}
TAPE_HD VecN<6> BodyDrive::gradient(const StateView& s, int i) const {
  return elements[i].stiffness.gradient(s.body[elements[i].body], s.body_target[elements[i].body]);
}
TAPE_HD MatN<6, 6> BodyDrive::hessian(const StateView& s, int i, HessianMode mode) const {
  return elements[i].stiffness.hessian(s.body[elements[i].body], s.body_target[elements[i].body], mode);
}
}  // namespace tape
