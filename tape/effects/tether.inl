#pragma once
#include "tape/effects/tether.hpp"

namespace tape {
TAPE_HD Vec3 Tether::pull(const StateView& s, int i) const {
  const Element& e = elements[i];
  return s.grip_stiffness[e.slot] * (s.x[e.v] - (anchored(i) ? s.x[e.anchor] : s.grip_target[e.slot]));
}
TAPE_HD Real Tether::energy(const StateView& s, int i) const {
  const Real k = s.grip_stiffness[elements[i].slot];
  return k > 0 ? pull(s, i).squaredNorm() / (2 * k) : 0;
}
TAPE_HD VecN<6> Tether::gradient(const StateView& s, int i) const {
  VecN<6> g = VecN<6>::Zero();
  g.head<3>() = pull(s, i);
  if (anchored(i)) g.tail<3>() = -g.head<3>();
  return g;
}
TAPE_HD MatN<6, 6> Tether::hessian(const StateView& s, int i, HessianMode) const {
  const Mat3 k = s.grip_stiffness[elements[i].slot] * Mat3::Identity();
  MatN<6, 6> h = MatN<6, 6>::Zero();
  h.topLeftCorner<3, 3>() = k;
  if (!anchored(i)) return h;
  h.bottomRightCorner<3, 3>() = k;
  h.topRightCorner<3, 3>() = h.bottomLeftCorner<3, 3>() = -k;
  return h;
}
}  // namespace tape
