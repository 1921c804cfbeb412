#pragma once
#include "tape/effects/barrier.hpp"
#include "tape/effects/coulomb.hpp"
#include "tape/effects/lagged_slip.hpp"

namespace tape {
/// Coulomb friction, smoothed and lagged [Li 2020]. At the start of a step each pair in contact fixes its normal force lambda_n; a slip u
/// (LaggedSlip) then costs
///   E = mu lambda_n f0(|u|)   (Coulomb),   eps = eps_v dt.
/// Below the speed eps_v a contact creeps instead of sticking. Pairs of nearly parallel edges are left out: their vertices' pairs carry the
/// force.
struct Friction {
  static constexpr std::string_view name = "friction";
  static constexpr bool incremental = true;
  struct Params {
    Real eps_v = 1e-4;
    SlipFrame frame = SlipFrame::turning;
    template <class F>
    void fields(F&& f) {
      f("eps_v", eps_v, "m/s", Range::above(0, 1), "sliding speed below which a contact counts as sticking");
      f("frame", frame, "", Range::any(),
        "slip by a frame that turns with the pair, or by the one of the start of the step (as published)");
    }
  };
  struct Element {
    LaggedSlip lagged;
    Real limit;  ///< [N] mu lambda_n
  };
  Span<const Element> elements;
  Real eps_v;
  SlipFrame frame;
  Barrier barrier;

  static std::string needed(const Scene& scene, const Params&) {
    if (Barrier::needed(scene, {}).empty()) return "";
    for (const Material& a : scene.materials)
      for (const Material& b : scene.materials)
        if (scene.mu(static_cast<int>(&a - scene.materials.data()), static_cast<int>(&b - scene.materials.data())) > 0)
          return "materials.mu";
    return "";
  }
  static Friction build(const Scene& scene, const Assembly& assembly, const Params& p, std::vector<Element>&) {
    std::vector<ContactPair> none;
    return {{}, p.eps_v, p.frame, Barrier::build(scene, assembly, {}, none)};
  }
  TAPE_HD bool lag(const ContactPair& pair, const StateView& s, Element& out) const {
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
  TAPE_HD Stencil<4> stencil(int i) const {
    const int(&v)[4] = elements[i].lagged.v;
    return {{v[0], v[1], v[2], v[3]}};
  }
  TAPE_HD Vec2 slip(const StateView& s, int i) const { return elements[i].lagged.slip(frame, s); }
  TAPE_HD Real energy(const StateView& s, int i) const { return elements[i].limit * law(s).value(slip(s, i).norm()); }
  TAPE_HD VecN<12> gradient(const StateView& s, int i) const {
    const Vec2 u = slip(s, i);
    return elements[i].lagged.slope(frame, s) * (elements[i].limit * law(s).secant(u.norm()) * u);
  }
  /// In the slip positive semidefinite as it is: f0 is convex. But it is flat along a slip beyond eps and does not see that f0 turns at
  /// slip 0. Where Newton overshoots, the secant f0'(y)/y stands in for both directions: the parabola through y that lies above f0
  /// everywhere.
  TAPE_HD MatN<12, 12> hessian(const StateView& s, int i, HessianMode mode) const {
    const Element& e = elements[i];
    const Vec2 u = slip(s, i);
    const Real y = u.norm(), pull = law(s).secant(y);
    Mat2 m = pull * Mat2::Identity();
    if (!s.overshot && y > 0) m -= Mat2(u * u.transpose()) * (law(s).bend(y) / (y * y));
    const MatN<12, 2> J = e.lagged.slope(frame, s);
    MatN<12, 12> h = e.limit * J * m * J.transpose();
    if (mode == HessianMode::exact && !s.overshot) e.lagged.add_curvature(frame, s, e.limit * pull * u, h);
    return h;
  }
  /// Along the slip and across it.
  template <class F>
  TAPE_HD bool squares(const StateView& s, int i, const F& add) const {
    const Element& e = elements[i];
    const Vec2 u = slip(s, i);
    const Real y = u.norm(), pull = law(s).secant(y);
    const MatN<12, 2> J = e.lagged.slope(frame, s);
    const Vec2 along = y > 0 ? Vec2(u / y) : Vec2(1, 0);
    add(e.limit * (pull - (s.overshot || !(y > 0) ? 0 : law(s).bend(y))), VecN<12>(J * along));
    add(e.limit * pull, VecN<12>(J * Vec2(-along.y(), along.x())));
    return true;
  }

 private:
  TAPE_HD Coulomb law(const StateView& s) const { return {eps_v * s.dt}; }
};
static_assert(Effect<Friction>);
}  // namespace tape
