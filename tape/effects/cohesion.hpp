#pragma once
#include "tape/effects/barrier_law.hpp"
#include "tape/effects/effect.hpp"
#include "tape/effects/triangle_plane.hpp"

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
/// beta is constant in a step and follows eq. 3 at its end. The slip is measured in the plane of the triangle, at the foot of the
/// vertex when the step started: with edges e_a of the triangle, r from that material point to the vertex (TrianglePlane), and the metric
/// G_ab = e_a.e_b of then, u has the covariant components e_a.r - (e_a.r at the start), |u|^2 = u^T G^-1 u. In a frame that stays behind,
/// a roll that turns would feel its layers slip.
struct Cohesion {
  static constexpr std::string_view name = "cohesion";
  using Params = NoParams;
  using Pair = ContactPair;
  /// What a pair remembers.
  struct Memory : VertexTriangle {
    Real beta;     ///< [1] engagement
    Real slip[2];  ///< [m^2] since bonding, covariant
    Real engagement(const Adhesion&) const { return beta; }
    template <class F>
    void visit(F&& f) {
      f(vertex), f(triangle), f(beta), f(slip[0]), f(slip[1]);
    }
  };
  struct Element {
    ContactPair pair;
    Real opening, sliding;  ///< [N/m] stiffness: beta^2 C_n/dhat, 2 beta^2 C_t/dhat
    Real rest;              ///< [m] d*
    Real foot[3];           ///< [1] barycentric coordinates of the vertex's foot
    Mat2 inverse_metric;    ///< [1/m^2] G^-1
    Vec2 start;             ///< [m^2] e_a.r where the slip is zero
  };
  Span<const Element> elements;
  Real dhat;   ///< [m]
  Real kappa;  ///< [Pa] of the barrier

  static std::string needed(const Scene& scene, const Params&) {
    for (const AdhesivePair& a : scene.adhesives)
      if (a.adhesion.law == AdhesionLaw::per_pair) return "interfaces";
    return "";
  }
  static Cohesion build(const Scene& scene, const Assembly&, const Params&, std::vector<Element>&) {
    return {{}, scene.dhat(), scene.contact.kappa};
  }

  /// The element of a remembered pair, at s.x == s.x_start.
  TAPE_HD Element recall(const Memory& m, const ContactPair& pair, const StateView& s) const {
    const PairCohesion& law = s.adhesion[pair.interface].pair;
    const PairState p = PairState::at(pair, s.x);
    Element e;
    e.pair = pair;
    e.opening = m.beta * m.beta * law.cn / dhat;
    e.sliding = 2 * m.beta * m.beta * law.ct / dhat;
    e.rest = pair.xi + dhat / 2;
    for (int k = 0; k < 3; ++k) e.foot[k] = -p.closest.weight[1 + k];
    const auto at = plane(e, s.x);
    e.inverse_metric = at.metric().inverse();
    e.start = at.along() - Vec2(m.slip[0], m.slip[1]);
    return e;
  }

  TAPE_HD Stencil<4> stencil(int i) const {
    const int(&v)[4] = elements[i].pair.v;
    return {{v[0], v[1], v[2], v[3]}};
  }
  TAPE_HD Real energy(const StateView& s, int i) const {
    const Element& e = elements[i];
    const Real open = PairState::at(e.pair, s.x).d - e.rest;
    const Vec2 slip = plane(e, s.x).along() - e.start;
    return e.opening / 2 * open * open + e.sliding / 2 * slip.dot(e.inverse_metric * slip);
  }
  TAPE_HD VecN<12> gradient(const StateView& s, int i) const {
    const Element& e = elements[i];
    const PairState p = PairState::at(e.pair, s.x);
    const auto at = plane(e, s.x);
    const Vec2 pull = e.sliding * e.inverse_metric * (at.along() - e.start);
    return e.opening * (p.d - e.rest) * p.gradient() + at.slope() * pull;
  }
  /// `projected` drops the curvature of the distance and of the slip: what stays are squares.
  TAPE_HD MatN<12, 12> hessian(const StateView& s, int i, HessianMode mode) const {
    const Element& e = elements[i];
    const PairState p = PairState::at(e.pair, s.x);
    const auto at = plane(e, s.x);
    const MatN<12, 2> J = at.slope();
    MatN<12, 12> h = e.sliding * J * e.inverse_metric * J.transpose();
    if (mode == HessianMode::exact) {
      h += p.hessian(e.opening * (p.d - e.rest), e.opening);
      at.add_curvature(e.sliding * e.inverse_metric * (at.along() - e.start), h);
    } else {
      const VecN<12> g = p.gradient();
      h += e.opening * g * g.transpose();
    }
    return h;
  }

  /// Whether a pair is remembered that was not before, at the end of a step.
  TAPE_HD bool begin(const ContactPair& pair, const StateView& s, Memory& out) const {
    const Adhesion& a = s.adhesion[pair.interface];
    if (pair.kind != PairKind::vertex_triangle || a.law != AdhesionLaw::per_pair) return false;
    const PairState p = PairState::at(pair, s.x);
    if (!(p.d < pair.xi + dhat) || !adheres(a, pair, p, s)) return false;
    const Real grown = s.dt * rate(a.pair, pair.xi, 0, p.d, 0);
    out = {pair.name(), std::fmin(std::fmax(a.pair.beta0, grown), 1), {0, 0}};
    return out.beta > 0;
  }
  /// What element i remembers at the end of a step. @return false: the pair is dropped
  TAPE_HD bool renew(const StateView& s, int i, Memory& m) const {
    const Element& e = elements[i];
    const PairCohesion& law = s.adhesion[e.pair.interface].pair;
    const Real d = PairState::at(e.pair, s.x).d;
    if (!(d - e.rest < law.drop * dhat)) return false;
    const Vec2 slip = plane(e, s.x).along() - e.start;
    m.beta = std::fmin(std::fmax(m.beta + s.dt * rate(law, e.pair.xi, m.beta, d, slip.dot(e.inverse_metric * slip)), 0), 1);
    for (int a = 0; a < 2; ++a) m.slip[a] = law.slip == SlipFrom::bonding ? slip[a] : 0;
    return true;
  }
  TAPE_HD AdhesiveForce force(const StateView& s, int i) const {
    const Element& e = elements[i];
    const Vec2 slip = plane(e, s.x).along() - e.start;
    return {.interface = e.pair.interface,
            .vertex = {e.pair.v[0]},
            .weight = {1},
            .live = e.opening > 0,
            .normal = e.opening * (PairState::at(e.pair, s.x).d - e.rest),
            .tangential = e.sliding * std::sqrt(slip.dot(e.inverse_metric * slip))};
  }
  /// d beta/dt [1/s].  Source: [the paper, eq. 3], without a gain where the barrier has no compression to compare with.
  /// @param slip2  [m^2] |u|^2
  TAPE_HD Real rate(const PairCohesion& law, Real xi, Real beta, Real d, Real slip2) const {
    const Real opening = (d - xi) / dhat - 0.5, a_n = 4 * opening * opening;
    const Real a_t = 4 * law.ct / law.cn * slip2 / (dhat * dhat);
    const Real p = compression(d, xi) - law.cn * beta * beta * opening, p_b = compression(xi + dhat / 2, xi);
    const auto lost = [&](Real a) { return 10 / law.eta * std::fmin(law.work - beta * a, 0); };
    if (p < 0) return lost(a_n + a_t);
    return (p_b > 0 ? 100 * law.gamma / p_b * std::fmax(p - beta * law.p0, 0) : 0) + lost(a_t);
  }

 private:
  TAPE_HD static TrianglePlane<4> plane(const Element& e, Span<const Vec3> x) {
    const int(&v)[4] = e.pair.v;
    const Vec3 at[4] = {x[v[0]], x[v[1]], x[v[2]], x[v[3]]};
    return TrianglePlane<4>(at, {1}, e.foot);
  }
  /// The part of p that the barrier B = kappa (r-1)^2 ln(r)^2 gives: -2 d dhat B'(d^2).
  TAPE_HD Real compression(Real d, Real xi) const { return -dhat * BarrierLaw{kappa, dhat}.at(d, xi, 4 / dhat).slope; }
};
static_assert(Effect<Cohesion>);
}  // namespace tape
