#pragma once
#include "tape/effects/axle.hpp"

namespace tape {
TAPE_HD Real Axle::energy(const StateView& s, int i) const {
  return elements[i].stiffness / 2 * (s.x[elements[i].end] - s.x[elements[i].seat]).squaredNorm();
}
TAPE_HD VecN<6> Axle::gradient(const StateView& s, int i) const {
  VecN<6> g;
  g.head<3>() = elements[i].stiffness * (s.x[elements[i].end] - s.x[elements[i].seat]);
  g.tail<3>() = -g.head<3>();
  return g;
}
TAPE_HD MatN<6, 6> Axle::hessian(const StateView&, int i, HessianMode) const {
  const Mat3 k = elements[i].stiffness * Mat3::Identity();
  MatN<6, 6> h;
  h << k, -k, -k, k;
  return h;
}
}  // namespace tape
