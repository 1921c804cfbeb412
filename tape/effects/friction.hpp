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
  TAPE_HD inline bool lag(const ContactPair& pair, const StateView& s, Element& out) const;
  TAPE_HD Stencil<4> stencil(int i) const {
    const int(&v)[4] = elements[i].lagged.v;
    return {{v[0], v[1], v[2], v[3]}};
  }
  TAPE_HD inline Vec2 slip(const StateView& s, int i) const;
  TAPE_HD inline Real energy(const StateView& s, int i) const;
  TAPE_HD inline VecN<12> gradient(const StateView& s, int i) const;
  /// In the slip positive semidefinite as it is: f0 is convex. But it is flat along a slip beyond eps and does not see that f0 turns at
  /// slip 0. Where Newton overshoots, the secant f0'(y)/y stands in for both directions: the parabola through y that lies above f0
  /// everywhere.
  TAPE_HD inline MatN<12, 12> hessian(const StateView& s, int i, HessianMode mode) const;
  /// Along the slip and across it.
  template <class F>
  TAPE_HD inline bool squares(const StateView& s, int i, const F& add) const;

 private:
  TAPE_HD Coulomb law(const StateView& s) const { return {eps_v * s.dt}; }
};
static_assert(Effect<Friction>);
}  // namespace tape
