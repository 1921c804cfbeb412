#pragma once
#include "tape/effects/barrier.inl"
#include "tape/effects/friction.hpp"
#include "tape/effects/lagged_slip.inl"

namespace tape {
TAPE_HD bool Friction::lag(const ContactPair& pair, const StateView& s, Element& out) const {
  const Real mu = s.mu[pair.interface];
  if (!(mu > 0)) return false;
  if (far_apart(pair, s.x, pair.xi + pair.dhat)) return false;
  const PairState p = PairState::at(pair, s.x);
  if (!Barrier::reaches(p, pair) || p.fade.slope != 0) return false;
  const Real force = barrier.normal_force(p, pair);
  if (!(force > 0)) return false;
  out = {LaggedSlip::at(pair, p, s.x), mu * force};
  return true;
}
TAPE_HD Vec2 Friction::slip(const StateView& s, int i) const { return elements[i].lagged.slip(frame, s); }
TAPE_HD Real Friction::energy(const StateView& s, int i) const { return elements[i].limit * law(s).value(slip(s, i).norm()); }
TAPE_HD VecN<12> Friction::gradient(const StateView& s, int i) const {
  const Vec2 u = slip(s, i);
  return elements[i].lagged.slope(frame, s) * (elements[i].limit * law(s).secant(u.norm()) * u);
}
TAPE_HD MatN<12, 12> Friction::hessian(const StateView& s, int i, HessianMode mode) const {
  const Element& e = elements[i];
  const Vec2 u = slip(s, i);
  const Real y = u.norm(), pull = law(s).secant(y);
  Mat2 m = pull * Mat2::Identity();
  if (!s.overshot && y > 0) m -= Mat2(u * u.transpose()) * (law(s).bend(y) / (y * y));
  const MatN<12, 2> J = e.lagged.slope(frame, s);
  const MatN<12, 2> Jm = J * (e.limit * m);
  MatN<12, 12> h = Jm.lazyProduct(J.transpose());
  if (mode == HessianMode::exact && !s.overshot) e.lagged.add_curvature(frame, s, e.limit * pull * u, h);
  return h;
}
template <class F>
TAPE_HD bool Friction::squares(const StateView& s, int i, const F& add) const {
  const Element& e = elements[i];
  const Vec2 u = slip(s, i);
  const Real y = u.norm(), pull = law(s).secant(y);
  const MatN<12, 2> J = e.lagged.slope(frame, s);
  const Vec2 along = y > 0 ? Vec2(u / y) : Vec2(1, 0);
  add(e.limit * (pull - (s.overshot || !(y > 0) ? 0 : law(s).bend(y))), VecN<12>(J * along));
  add(e.limit * pull, VecN<12>(J * Vec2(-along.y(), along.x())));
  return true;
}
}  // namespace tape
