#pragma once
#include <limits>

#include "tape/effects/bonds.hpp"
#include "tape/effects/cohesion.inl"
#include "tape/math/psd.hpp"

namespace tape {
TAPE_HD Bonds::Element Bonds::recall(const Memory& m, const ContactPair& pair, const StateView& s) const {
  const Real volume = 1 / (6 * std::fabs(m.inverse.determinant()));
  return {pair, m.inverse, m.cooldown > 0 ? 0 : volume * s.adhesion[pair.interface].bond.kappa_b, m.rest};
}
TAPE_HD Real Bonds::energy(const StateView& s, int i) const {
  const Element& e = elements[i];
  if (!(e.stiffness > 0)) return 0;
  return e.stiffness * strain(deformation(e, s)).squaredNorm() + guard(e, PairState::at(e.pair, s.x)).value;
}
TAPE_HD VecN<12> Bonds::gradient(const StateView& s, int i) const {
  const Element& e = elements[i];
  const PairState p = PairState::at(e.pair, s.x);
  return bond_gradient(e, s) + guard(e, p).slope * p.gradient();
}
TAPE_HD MatN<12, 12> Bonds::hessian(const StateView& s, int i, HessianMode mode) const {
  const Element& e = elements[i];
  const Mat3 F = deformation(e, s);
  const Mat3 S = mode == HessianMode::exact ? strain(F) : psd_part(strain(F));
  Vec3 b[4], f[4];
  for (int k = 0; k < 4; ++k) b[k] = row(e, k), f[k] = F * b[k];
  MatN<12, 12> h;
  for (int k = 0; k < 4; ++k)
    for (int l = 0; l < 4; ++l)
      h.block<3, 3>(3 * k, 3 * l) = 4 * e.stiffness * (f[k].dot(f[l]) * Mat3::Identity() + f[l] * f[k].transpose() + b[k].dot(b[l]) * S);
  const PairState p = PairState::at(e.pair, s.x);
  const Jet wall = guard(e, p);
  if (wall.curvature == 0) return h;
  const VecN<12> g = p.gradient();
  if (mode == HessianMode::exact) return h + p.hessian(wall.slope, wall.curvature);
  return h + wall.curvature * g * g.transpose();
}
TAPE_HD bool Bonds::begin(const ContactPair& pair, const StateView& s, Memory& out) const {
  const Adhesion& a = s.adhesion[pair.interface];
  if (a.law != of_law || far_apart(pair, s.x, pair.xi + a.bond.reach * dhat)) return false;
  const PairState p = PairState::at(pair, s.x);
  const Real gap = (p.d - pair.xi) / dhat;
  constexpr Real kFlat = 1e-6;  // [m] a tetrahedron that is no higher has no shape to remember
  if (p.closest.free != 2 || !(p.d > kFlat) || !(gap < a.bond.reach && gap >= a.bond.floor) || !adheres(a, pair, p, s)) return false;
  out = {pair.name(), 0, p.d, edges(p.x).inverse()};
  return true;
}
TAPE_HD Real Bonds::load(const StateView& s, int i) const {
  const Element& e = elements[i];
  if (!(e.stiffness > 0) || !in_tension(e, s)) return 0;
  return bond_gradient(e, s).head<3>().norm() / s.adhesion[e.pair.interface].bond.break_force;
}
TAPE_HD Real Bonds::accuracy_to_judge(const StateView& s, int i) const {
  return load(s, i) > 0.8 ? 0.05 * stretch_to_break(s, i) : std::numeric_limits<Real>::infinity();
}
TAPE_HD Real Bonds::slack(const StateView& s, int i) const {
  if (!(elements[i].stiffness > 0)) return 0;
  return std::fmax(1 - load(s, i), 0) * stretch_to_break(s, i);
}
TAPE_HD Real Bonds::stretch_to_break(const StateView& s, int i) const {
  const Element& e = elements[i];
  return s.adhesion[e.pair.interface].bond.break_force * e.rest * e.rest / (8 * e.stiffness);
}
TAPE_HD AdhesiveForce Bonds::force(const StateView& s, int i) const {
  const Element& e = elements[i];
  const PairState p = PairState::at(e.pair, s.x);
  const Vec3 pull = e.stiffness > 0 ? Vec3(gradient(s, i).head<3>()) : Vec3(Vec3::Zero()), n = p.normal();
  return {.interface = e.pair.interface,
          .vertex = {e.pair.v[0]},
          .weight = {1},
          .live = e.stiffness > 0,
          .normal = pull.dot(n),
          .tangential = (pull - pull.dot(n) * n).norm()};
}
TAPE_HD Mat3 Bonds::edges(const Vec3 (&x)[4]) {
  Mat3 D;
  for (int k = 0; k < 3; ++k) D.col(k) = x[k + 1] - x[0];
  return D;
}
TAPE_HD Mat3 Bonds::deformation(const Element& e, const StateView& s) {
  const int(&v)[4] = e.pair.v;
  const Vec3 x[4] = {s.x[v[0]], s.x[v[1]], s.x[v[2]], s.x[v[3]]};
  return edges(x) * e.inverse;
}
TAPE_HD bool Bonds::in_tension(const Element& e, const StateView& s) { return PairState::at(e.pair, s.x).d > e.rest * (1 + 1e-9); }
TAPE_HD Mat3 Bonds::strain(const Mat3& F) { return F * F.transpose() - Mat3::Identity(); }
TAPE_HD Vec3 Bonds::row(const Element& e, int k) {
  if (k > 0) return e.inverse.row(k - 1).transpose();
  return -e.inverse.colwise().sum().transpose();
}
TAPE_HD VecN<12> Bonds::bond_gradient(const Element& e, const StateView& s) {
  const Mat3 F = deformation(e, s), P = 4 * e.stiffness * strain(F) * F;
  VecN<12> g;
  for (int k = 0; k < 4; ++k) g.segment<3>(3 * k) = P * row(e, k);
  return g;
}
TAPE_HD Jet Bonds::guard(const Element& e, const PairState& p) const {
  return BarrierLaw{e.pair.kappa, e.rest / 2}.at(p.d, 0, e.pair.weight);
}
}  // namespace tape
