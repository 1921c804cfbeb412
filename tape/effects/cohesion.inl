#pragma once
#include "tape/effects/barrier_law.hpp"
#include "tape/effects/cohesion.hpp"
#include "tape/effects/lagged_slip.inl"

namespace tape {
/// Whether the faces that vertex and triangle turn to each other adhere. The offset of the pair points to the vertex.
TAPE_HD inline bool adheres(const Adhesion& adhesion, const ContactPair& pair, const PairState& p, const StateView& s) {
  const Face of_vertex = s.fans.area_normal(s.x, pair.v[0]).dot(p.offset) > 0 ? Face::sticky : Face::backing;
  const Face of_triangle = (p.x[2] - p.x[1]).cross(p.x[3] - p.x[1]).dot(p.offset) < 0 ? Face::sticky : Face::backing;
  return adhesion.sticks[static_cast<int>(of_vertex)][static_cast<int>(of_triangle)];
}

TAPE_HD Cohesion::Element Cohesion::recall(const Memory& m, const ContactPair& pair, const StateView& s) const {
  const PairCohesion& a = s.adhesion[pair.interface].pair;
  const PairState p = PairState::at(pair, s.x);
  Element e{pair, LaggedSlip::at(pair, p, s.x), m.beta * m.beta * a.cn / dhat, 2 * m.beta * m.beta * a.ct / dhat, pair.xi + dhat / 2};
  if (a.slip == SlipFrom::bonding) e.lagged.before = e.lagged.recalled(m.slip);
  return e;
}
TAPE_HD Vec2 Cohesion::slip(const StateView& s, int i) const { return elements[i].lagged.slip(frame, s); }
TAPE_HD Real Cohesion::energy(const StateView& s, int i) const {
  const Element& e = elements[i];
  const Real open = PairState::at(e.pair, s.x).d - e.rest;
  return e.opening / 2 * open * open + e.sliding / 2 * slip(s, i).squaredNorm();
}
TAPE_HD VecN<12> Cohesion::gradient(const StateView& s, int i) const {
  const Element& e = elements[i];
  const PairState p = PairState::at(e.pair, s.x);
  return e.opening * (p.d - e.rest) * p.gradient() + e.lagged.slope(frame, s) * (e.sliding * slip(s, i));
}
TAPE_HD MatN<12, 12> Cohesion::hessian(const StateView& s, int i, HessianMode mode) const {
  const Element& e = elements[i];
  const PairState p = PairState::at(e.pair, s.x);
  const MatN<12, 2> J = e.lagged.slope(frame, s);
  MatN<12, 12> h = (e.sliding * J).lazyProduct(J.transpose());
  if (mode == HessianMode::exact) {
    h += p.hessian(e.opening * (p.d - e.rest), e.opening);
    e.lagged.add_curvature(frame, s, e.sliding * slip(s, i), h);
  } else {
    const VecN<12> g = p.gradient();
    h += e.opening * g * g.transpose();
  }
  return h;
}
template <class F>
TAPE_HD bool Cohesion::squares(const StateView& s, int i, const F& add) const {
  const Element& e = elements[i];
  const MatN<12, 2> J = e.lagged.slope(frame, s);
  add(e.opening, PairState::at(e.pair, s.x).gradient());
  for (int c = 0; c < 2; ++c) add(e.sliding, VecN<12>(J.col(c)));
  return true;
}
TAPE_HD bool Cohesion::begin(const ContactPair& pair, const StateView& s, Memory& out) const {
  const Adhesion& a = s.adhesion[pair.interface];
  if (pair.kind != PairKind::vertex_triangle || a.law != of_law || far_apart(pair, s.x, pair.xi + dhat)) return false;
  const PairState p = PairState::at(pair, s.x);
  if (!(p.d < pair.xi + dhat) || !adheres(a, pair, p, s)) return false;
  const Real grown = s.dt * rate(a.pair, pair, 0, p.d, 0);
  out = {pair.name(), std::fmin(std::fmax(a.pair.beta0, grown), 1), Vec3::Zero()};
  return out.beta > 0;
}
TAPE_HD bool Cohesion::renew(const StateView& s, int i, Memory& m) const {
  const Element& e = elements[i];
  const PairCohesion& a = s.adhesion[e.pair.interface].pair;
  const Real d = PairState::at(e.pair, s.x).d;
  if (!(d - e.rest < a.drop * dhat)) return false;
  const Vec2 u = slip(s, i);
  m.beta = std::fmin(std::fmax(m.beta + s.dt * rate(a, e.pair, m.beta, d, u.squaredNorm()), 0), 1);
  m.slip = a.slip == SlipFrom::bonding ? e.lagged.remembered(u, s) : Vec3(Vec3::Zero());
  return true;
}
TAPE_HD Real Cohesion::slack(const StateView& s, int i) const {
  const Element& e = elements[i];
  const PairCohesion& a = s.adhesion[e.pair.interface].pair;
  const Real d = PairState::at(e.pair, s.x).d, slip2 = slip(s, i).squaredNorm(), whole = a.cn / dhat;
  const bool grows = e.opening < whole && rate(a, e.pair, std::sqrt(e.opening / whole), d, slip2) > 0;
  if (a.slip == SlipFrom::step || grows) return 0;
  const Real ratio = std::sqrt(a.ct / a.cn), strain = 2 / dhat * std::hypot(std::fmax(d - e.rest, 0), ratio * std::sqrt(slip2));
  const Real to_loss = (std::sqrt(a.work) - strain) * dhat / (2 * std::fmax(1, ratio));  // strain^2 is a_n + a_t of `rate`
  return std::fmax(std::fmin(to_loss, a.drop * dhat - (d - e.rest)), 0);
}
TAPE_HD AdhesiveForce Cohesion::force(const StateView& s, int i) const {
  const Element& e = elements[i];
  return {.interface = e.pair.interface,
          .vertex = {e.pair.v[0]},
          .weight = {1},
          .live = e.opening > 0,
          .normal = e.opening * (PairState::at(e.pair, s.x).d - e.rest),
          .tangential = e.sliding * slip(s, i).norm()};
}
TAPE_HD Real Cohesion::rate(const PairCohesion& a, const ContactPair& pair, Real beta, Real d, Real slip2) const {
  const Real opening = (d - pair.xi) / dhat - 0.5, a_n = 4 * opening * opening;
  const Real a_t = 4 * a.ct / a.cn * slip2 / (dhat * dhat);
  const Real p = compression(pair, d) - a.cn * beta * beta * opening, p_b = compression(pair, pair.xi + dhat / 2);
  const auto lost = [&](Real strain) { return 10 / a.eta * std::fmin(a.work - beta * strain, 0); };
  if (p < 0) return lost(a_n + a_t);
  return (p_b > 0 ? 100 * a.gamma / p_b * std::fmax(p - beta * a.p0, 0) : 0) + lost(a_t);
}
TAPE_HD Real Cohesion::compression(const ContactPair& pair, Real d) const {
  return -dhat * BarrierLaw{pair.kappa, dhat}.at(d, pair.xi, 4 / dhat).slope;
}
}  // namespace tape
