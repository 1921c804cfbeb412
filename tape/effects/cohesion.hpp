#pragma once
#include "tape/effects/effect.hpp"
#include "tape/effects/lagged_slip.hpp"

namespace tape {
/// Cohesive adhesion of vertex-triangle pairs with memory, law `per_pair`: with engagement beta, distance d, rest distance
/// d* = xi + dhat/2 and tangential slip u,
///   E = beta^2 [C_n / (2 dhat) (d - d*)^2 + C_t / dhat |u|^2]           [the paper, eq. 2]
/// beta is constant in a step and follows eq. 3 at its end. The slip is that of LaggedSlip: in a frame that stays behind, a roll that turns
/// would feel its layers slip.
struct Cohesion {
  static constexpr std::string_view name = "cohesion";
  struct Params {
    SlipFrame frame = SlipFrame::turning;
    template <class F>
    void fields(F&& f) {
      f("frame", frame, "", Range::any(), "slip by a frame that turns with the pair, or by the one of the start of the step (the paper)");
    }
  };
  using Pair = ContactPair;
  /// What a pair remembers.
  struct Memory : VertexTriangle {
    Real beta;  ///< [1] engagement
    Vec3 slip;  ///< since bonding, as LaggedSlip remembers it
    Real engagement(const Adhesion&) const { return beta; }
    template <class F>
    void visit(F&& f) {
      f(vertex), f(triangle), f(beta), f(slip);
    }
  };
  struct Element {
    ContactPair pair;
    LaggedSlip lagged;
    Real opening, sliding;  ///< [N/m] stiffness: beta^2 C_n/dhat, 2 beta^2 C_t/dhat
    Real rest;              ///< [m] d*
  };
  Span<const Element> elements;
  Real dhat;  ///< [m]
  SlipFrame frame = SlipFrame::turning;

  static constexpr AdhesionLaw of_law = AdhesionLaw::per_pair;
  static std::string needed(const Scene& scene, const Params&) { return scene.uses(of_law) ? "interfaces" : ""; }
  static Cohesion build(const Scene& scene, const Assembly&, const Params& p, std::vector<Element>&) { return {{}, scene.dhat(), p.frame}; }

  /// The element of a remembered pair, at s.x == s.x_start.
  TAPE_HD inline Element recall(const Memory& m, const ContactPair& pair, const StateView& s) const;

  TAPE_HD Stencil<4> stencil(int i) const {
    const int(&v)[4] = elements[i].pair.v;
    return {{v[0], v[1], v[2], v[3]}};
  }
  TAPE_HD inline Vec2 slip(const StateView& s, int i) const;
  TAPE_HD inline Real energy(const StateView& s, int i) const;
  TAPE_HD inline VecN<12> gradient(const StateView& s, int i) const;
  /// `projected` drops the curvature of the distance and of the slip: what stays are squares.
  TAPE_HD inline MatN<12, 12> hessian(const StateView& s, int i, HessianMode mode) const;

  template <class F>
  TAPE_HD inline bool squares(const StateView& s, int i, const F& add) const;

  /// Whether a pair is remembered that was not before, at the end of a step.
  TAPE_HD inline bool begin(const ContactPair& pair, const StateView& s, Memory& out) const;
  /// What element i remembers at the end of a step. @return false: the pair is dropped
  TAPE_HD inline bool renew(const StateView& s, int i, Memory& m) const;
  /// To where beta may fall or the pair is dropped. Where beta grows, or slip is that of each step, it changes in time.
  TAPE_HD inline Real slack(const StateView& s, int i) const;
  TAPE_HD inline AdhesiveForce force(const StateView& s, int i) const;
  /// d beta/dt [1/s].  Source: [the paper, eq. 3], without a gain where the barrier has no compression to compare with.
  /// @param slip2  [m^2] |u|^2
  TAPE_HD inline Real rate(const PairCohesion& a, const ContactPair& pair, Real beta, Real d, Real slip2) const;

 private:
  /// The part of p that the barrier B = kappa (r-1)^2 ln(r)^2 gives: -2 d dhat B'(d^2).
  TAPE_HD inline Real compression(const ContactPair& pair, Real d) const;
};
static_assert(Effect<Cohesion>);
}  // namespace tape
