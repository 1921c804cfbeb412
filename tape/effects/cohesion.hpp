#pragma once
#include "tape/effects/barrier_law.hpp"
#include "tape/effects/effect.hpp"
#include "tape/effects/lagged_slip.hpp"

namespace tape {
/// Whether the faces that vertex and triangle turn to each other adhere. The offset of the pair points to the vertex.
TAPE_HD inline bool adheres(const Adhesion& adhesion, const ContactPair& pair, const PairState& p, const StateView& s) {
  const Face of_vertex = s.normal[pair.v[0]].dot(p.offset) > 0 ? Face::sticky : Face::backing;
  const Face of_triangle = (p.x[2] - p.x[1]).cross(p.x[3] - p.x[1]).dot(p.offset) < 0 ? Face::sticky : Face::backing;
  return adhesion.sticks[static_cast<int>(of_vertex)][static_cast<int>(of_triangle)];
}

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
  Real dhat;   ///< [m]
  Real kappa;  ///< [Pa] of the barrier
  SlipFrame frame = SlipFrame::turning;

  static constexpr AdhesionLaw of_law = AdhesionLaw::per_pair;
  static std::string needed(const Scene& scene, const Params&) { return scene.uses(of_law) ? "interfaces" : ""; }
  static Cohesion build(const Scene& scene, const Assembly&, const Params& p, std::vector<Element>&) {
    return {{}, scene.dhat(), scene.contact.kappa, p.frame};
  }

  /// The element of a remembered pair, at s.x == s.x_start.
  TAPE_HD Element recall(const Memory& m, const ContactPair& pair, const StateView& s) const {
    const PairCohesion& a = s.adhesion[pair.interface].pair;
    const PairState p = PairState::at(pair, s.x);
    Element e{pair, LaggedSlip::at(pair, p, s.x), m.beta * m.beta * a.cn / dhat, 2 * m.beta * m.beta * a.ct / dhat, pair.xi + dhat / 2};
    e.lagged.before = e.lagged.recalled(m.slip);
    return e;
  }

  TAPE_HD Stencil<4> stencil(int i) const {
    const int(&v)[4] = elements[i].pair.v;
    return {{v[0], v[1], v[2], v[3]}};
  }
  TAPE_HD Vec2 slip(const StateView& s, int i) const { return elements[i].lagged.slip(frame, s); }
  TAPE_HD Real energy(const StateView& s, int i) const {
    const Element& e = elements[i];
    const Real open = PairState::at(e.pair, s.x).d - e.rest;
    return e.opening / 2 * open * open + e.sliding / 2 * slip(s, i).squaredNorm();
  }
  TAPE_HD VecN<12> gradient(const StateView& s, int i) const {
    const Element& e = elements[i];
    const PairState p = PairState::at(e.pair, s.x);
    return e.opening * (p.d - e.rest) * p.gradient() + e.lagged.slope(frame, s) * (e.sliding * slip(s, i));
  }
  /// `projected` drops the curvature of the distance and of the slip: what stays are squares.
  TAPE_HD MatN<12, 12> hessian(const StateView& s, int i, HessianMode mode) const {
    const Element& e = elements[i];
    const PairState p = PairState::at(e.pair, s.x);
    const MatN<12, 2> J = e.lagged.slope(frame, s);
    MatN<12, 12> h = e.sliding * J * J.transpose();
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
  TAPE_HD bool squares(const StateView& s, int i, const F& add) const {
    const Element& e = elements[i];
    const MatN<12, 2> J = e.lagged.slope(frame, s);
    add(e.opening, PairState::at(e.pair, s.x).gradient());
    for (int c = 0; c < 2; ++c) add(e.sliding, VecN<12>(J.col(c)));
    return true;
  }

  /// Whether a pair is remembered that was not before, at the end of a step.
  TAPE_HD bool begin(const ContactPair& pair, const StateView& s, Memory& out) const {
    const Adhesion& a = s.adhesion[pair.interface];
    if (pair.kind != PairKind::vertex_triangle || a.law != of_law || far_apart(pair, s.x, pair.xi + dhat)) return false;
    const PairState p = PairState::at(pair, s.x);
    if (!(p.d < pair.xi + dhat) || !adheres(a, pair, p, s)) return false;
    const Real grown = s.dt * rate(a.pair, pair.xi, 0, p.d, 0);
    out = {pair.name(), std::fmin(std::fmax(a.pair.beta0, grown), 1), Vec3::Zero()};
    return out.beta > 0;
  }
  /// What element i remembers at the end of a step. @return false: the pair is dropped
  TAPE_HD bool renew(const StateView& s, int i, Memory& m) const {
    const Element& e = elements[i];
    const PairCohesion& a = s.adhesion[e.pair.interface].pair;
    const Real d = PairState::at(e.pair, s.x).d;
    if (!(d - e.rest < a.drop * dhat)) return false;
    const Vec2 u = slip(s, i);
    m.beta = std::fmin(std::fmax(m.beta + s.dt * rate(a, e.pair.xi, m.beta, d, u.squaredNorm()), 0), 1);
    m.slip = a.slip == SlipFrom::bonding ? e.lagged.remembered(u, s) : Vec3(Vec3::Zero());
    return true;
  }
  TAPE_HD AdhesiveForce force(const StateView& s, int i) const {
    const Element& e = elements[i];
    return {.interface = e.pair.interface,
            .vertex = {e.pair.v[0]},
            .weight = {1},
            .live = e.opening > 0,
            .normal = e.opening * (PairState::at(e.pair, s.x).d - e.rest),
            .tangential = e.sliding * slip(s, i).norm()};
  }
  /// d beta/dt [1/s].  Source: [the paper, eq. 3], without a gain where the barrier has no compression to compare with.
  /// @param slip2  [m^2] |u|^2
  TAPE_HD Real rate(const PairCohesion& a, Real xi, Real beta, Real d, Real slip2) const {
    const Real opening = (d - xi) / dhat - 0.5, a_n = 4 * opening * opening;
    const Real a_t = 4 * a.ct / a.cn * slip2 / (dhat * dhat);
    const Real p = compression(d, xi) - a.cn * beta * beta * opening, p_b = compression(xi + dhat / 2, xi);
    const auto lost = [&](Real strain) { return 10 / a.eta * std::fmin(a.work - beta * strain, 0); };
    if (p < 0) return lost(a_n + a_t);
    return (p_b > 0 ? 100 * a.gamma / p_b * std::fmax(p - beta * a.p0, 0) : 0) + lost(a_t);
  }

 private:
  /// The part of p that the barrier B = kappa (r-1)^2 ln(r)^2 gives: -2 d dhat B'(d^2).
  TAPE_HD Real compression(Real d, Real xi) const { return -dhat * BarrierLaw{kappa, dhat}.at(d, xi, 4 / dhat).slope; }
};
static_assert(Effect<Cohesion>);
}  // namespace tape
