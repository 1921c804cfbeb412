#pragma once
#include "tape/effects/seat.hpp"
#include "tape/math/rotation.hpp"

namespace tape {
struct Seat::At {
  Mat3 R;           ///< of the hub
  Vec3 arm, apart;  ///< [m] in the world: R_c a; t_c + R_c a - t_h
  Mat3 turned;      ///< R_c Q^T
  VecN<6> xi;
  MatN<3, 3> slope;  ///< of axial(M)/2 by a rotation vector in the hub's frame
};
TAPE_HD Seat::At Seat::at(const StateView& s, int i) const {
  const Element& e = elements[i];
  const Pose &hub = s.body[e.hub], &cluster = s.body[e.cluster];
  At at;
  at.R = hub.rotation;
  at.arm = cluster.rotation * e.arm;
  at.apart = cluster.position + at.arm - hub.position;
  at.turned = cluster.rotation * e.turn.transpose();
  const Mat3 M = hub.rotation.transpose() * at.turned;
  at.xi << hub.rotation.transpose() * at.apart, axial(M) / 2;
  at.slope = (M.trace() * Mat3::Identity() - M) / 2;
  return at;
}
TAPE_HD Real Seat::energy(const StateView& s, int i) const {
  const PlaceForm& form = elements[i].form;
  const VecN<6> xi = at(s, i).xi;
  return form.energy + form.force.dot(xi) + xi.dot(form.stiffness * xi) / 2;
}
TAPE_HD VecN<12> Seat::gradient(const StateView& s, int i) const {
  const At a = at(s, i);
  const VecN<6> f = elements[i].form.force + elements[i].form.stiffness * a.xi;
  const Vec3 force = a.R * f.head<3>(), torque = a.R * (a.slope.transpose() * f.tail<3>());
  VecN<12> g;
  g << -force, -a.apart.cross(force) - torque, force, a.arm.cross(force) + torque;
  return g;
}
TAPE_HD MatN<12, 12> Seat::hessian(const StateView& s, int i, HessianMode mode) const {
  const PlaceForm& form = elements[i].form;
  const At a = at(s, i);
  const Mat3 Rt = a.R.transpose(), turn = a.slope * Rt;
  MatN<6, 12> J = MatN<6, 12>::Zero();
  J.topRows<3>() << -Rt, Rt * skew(a.apart), Rt, -Rt * skew(a.arm);
  J.block<3, 3>(3, 3) = -turn;
  J.block<3, 3>(3, 9) = turn;
  const MatN<6, 12> KJ = form.stiffness * J;
  MatN<12, 12> h = J.transpose().lazyProduct(KJ);
  if (mode == HessianMode::projected) return h;
  // Of u.(R_h exp(-w_h) ... ) and of -tr(G exp(-w_h) exp(w_c))/2, to second order in the rotation vectors.
  const VecN<6> f = form.force + form.stiffness * a.xi;
  const Vec3 u = a.R * f.head<3>();
  const Mat3 I = Mat3::Identity(), G = a.turned * skew(f.tail<3>()) * Rt;
  const auto swing = [&](const Vec3& r) { return Mat3((u * r.transpose() + r * u.transpose()) / 2 - u.dot(r) * I); };
  const Mat3 twist = (G.trace() * I - (G + G.transpose()) / 2) / 2;
  const Mat3 both = a.arm.dot(u) * I - a.arm * u.transpose() + (G - G.trace() * I) / 2;  // by (w_h, w_c)
  h.block<3, 3>(3, 3) += swing(a.apart) + twist;
  h.block<3, 3>(9, 9) += swing(a.arm) + twist;
  h.block<3, 3>(3, 9) += both;
  h.block<3, 3>(9, 3) += both.transpose();
  h.block<3, 3>(0, 3) += skew(u);
  h.block<3, 3>(3, 0) -= skew(u);
  h.block<3, 3>(6, 3) -= skew(u);
  h.block<3, 3>(3, 6) += skew(u);
  return h;
}
}  // namespace tape
