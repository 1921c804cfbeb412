#pragma once
#include "tape/effects/bending.hpp"
#include "tape/math/dihedral.hpp"

namespace tape {
struct Bending::Angles {
  Real theta[3];
  MatN<3, 18> slope;
};

TAPE_HD Real Bending::energy(const StateView& s, int i) const {
  Real theta[3];
  for (int k = 0; k < 3; ++k) theta[k] = free_edge(i, k) ? 0 : at_edge(s, i, k).angle;
  return 0.5 * (theta[0] * moment(i, theta, 0) + theta[1] * moment(i, theta, 1) + theta[2] * moment(i, theta, 2));
}
TAPE_HD VecN<18> Bending::gradient(const StateView& s, int i) const {
  const Angles a = angles(s, i);
  return a.slope.transpose() * Vec3(moment(i, a.theta, 0), moment(i, a.theta, 1), moment(i, a.theta, 2));
}
TAPE_HD MatN<18, 18> Bending::hessian(const StateView& s, int i, HessianMode mode) const {
  const Angles a = angles(s, i);
  const Mat3 K = Eigen::Map<const Mat3>(&elements[i].K[0][0]);
  const MatN<3, 18> moments = K * a.slope;
  MatN<18, 18> h = a.slope.transpose().lazyProduct(moments);
  if (mode == HessianMode::projected) return h;
  for (int k = 0; k < 3; ++k) {
    if (free_edge(i, k)) continue;
    Vec3 x[4];
    positions(s, i, k, x);
    const MatN<12, 12> second = moment(i, a.theta, k) * dihedral_hessian(x);
    for (int p = 0; p < 4; ++p)
      for (int q = 0; q < 4; ++q) h.block<3, 3>(3 * corner(k, p), 3 * corner(k, q)) += second.block<3, 3>(3 * p, 3 * q);
  }
  return h;
}
TAPE_HD Real Bending::moment(int i, const Real (&theta)[3], int k) const {
  const Real(&row)[3] = elements[i].K[k];
  return row[0] * theta[0] + row[1] * theta[1] + row[2] * theta[2];
}
TAPE_HD void Bending::positions(const StateView& s, int i, int k, Vec3 (&x)[4]) const {
  for (int p = 0; p < 4; ++p) x[p] = s.x[elements[i].v[corner(k, p)]];
}
TAPE_HD Dihedral Bending::at_edge(const StateView& s, int i, int k) const {
  Vec3 x[4];
  positions(s, i, k, x);
  return dihedral(x);
}
TAPE_HD Bending::Angles Bending::angles(const StateView& s, int i) const {
  Angles a{{0, 0, 0}, MatN<3, 18>::Zero()};
  for (int k = 0; k < 3; ++k) {
    if (free_edge(i, k)) continue;
    const Dihedral d = at_edge(s, i, k);
    a.theta[k] = d.angle;
    for (int p = 0; p < 4; ++p) a.slope.block<1, 3>(k, 3 * corner(k, p)) = d.gradient[p].transpose();
  }
  return a;
}
}  // namespace tape
