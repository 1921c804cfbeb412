#pragma once
#include "tape/effects/effect.hpp"
#include "tape/effects/triangle_plane.hpp"

namespace tape {
/// Cohesive adhesion by area, law `per_area`: every triangle of a strip is cut into n^2 pieces, and the sample in the middle of each sticks
/// to the point of another triangle that is nearest when they meet. With the height h of the sample over the triangle's plane, its height
/// d* at rest and the slip u in the plane,
///   E = area phi(delta),   delta^2 = max(h - d*, 0)^2 + r |u|^2,   phi' the traction of AreaCohesion.
/// Up to the largest opening that was ever reached at the end of a step the traction runs back along its secant: what was torn stays
/// torn, and the work of separation does not depend on dt. Beyond it softens within the step.
/// With c_a = e_a.r along the triangle's edges (TrianglePlane), and their metric G when the step started, h^2 = |r|^2 - c^T G^-1 c and
/// |u|^2 = (c - c*)^T G^-1 (c - c*), c* when they met.  Source: design, part 5.
struct CohesiveZone {
  static constexpr std::string_view name = "cohesive_zone";
  struct Params {
    int samples = 2;
    template <class F>
    void fields(F&& f) {
      f("samples", samples, "1", Range::closed(1, 10), "n, pieces along a side of a strip's triangle; n^2 of them stick one by one");
    }
  };
  using Pair = SamplePair;
  /// What a sample that sticks remembers.
  struct Memory : SampleTriangle {
    Real foot[3];  ///< [1] barycentric coordinates of the point that it sticks to
    Real met[2];   ///< [m^2] c*
    Real worst;    ///< [m] largest opening so far
    Real engagement(const Adhesion& a) const { return Zone::at(a.area, worst).secant / Zone::at(a.area, 0).secant; }
    template <class F>
    void visit(F&& f) {
      f(sample), f(triangle), f(foot[0]), f(foot[1]), f(foot[2]), f(met[0]), f(met[1]), f(worst);
    }
  };
  /// Traction [Pa] by opening [m]: `secant` delta to the knee, then `softening` (final - delta) to nothing.
  struct Zone {
    Real knee, secant, softening, final;
    TAPE_HD static Zone at(const AreaCohesion& law, Real worst) {
      const Real final = law.final_opening(), peak = law.peak * final;
      const Real knee = std::fmin(std::fmax(worst, peak), final), softening = law.strength / (final - peak);
      return {knee, softening * (final - knee) / knee, softening, final};
    }
    /// [J/m^2]
    TAPE_HD Real work(Real delta) const {
      if (delta <= knee) return secant / 2 * delta * delta;
      const Real left = final - std::fmin(delta, final), whole = final - knee;
      return secant / 2 * knee * knee + softening / 2 * (whole * whole - left * left);
    }
    /// Derivative of the work by delta^2 [Pa/m], half the secant at delta.
    TAPE_HD Real slope(Real delta) const { return delta <= knee ? secant / 2 : softening * std::fmax(final - delta, 0) / (2 * delta); }
    /// Second derivative by delta^2 [Pa/m^3].
    TAPE_HD Real curvature(Real delta) const {
      return delta <= knee || delta >= final ? 0 : -softening * final / (4 * delta * delta * delta);
    }
  };
  struct Element {
    SamplePair pair;
    Zone zone;
    Real area;            ///< [m^2]
    Real shear;           ///< r
    Real foot[3];         ///< [1]
    Mat2 inverse_metric;  ///< [1/m^2] G^-1
    Vec2 met;             ///< [m^2] c*
    Real rest;            ///< [m] d*
  };
  Span<const Element> elements;
  Real dhat;      ///< [m]
  int samples;    ///< n
  int triangles;  ///< those of strips, the first of the surface

  static constexpr AdhesionLaw of_law = AdhesionLaw::per_area;
  static std::string needed(const Scene& scene, const Params&) { return scene.uses(of_law) ? "interfaces" : ""; }
  static CohesiveZone build(const Scene& scene, const Assembly& assembly, const Params& params, std::vector<Element>&) {
    int triangles = 0;
    for (const StripPart& strip : assembly.strips) triangles += strip.triangles;
    return {{}, scene.dhat(), params.samples, triangles};
  }
  /// Number of samples of all strips.
  TAPE_HD int count() const { return triangles * samples * samples; }

  /// Where strip sticks to strip, the samples of both do, each for half of its area.
  TAPE_HD Element recall(const Memory& m, const SamplePair& pair, const StateView& s) const {
    const AreaCohesion& law = s.adhesion[pair.interface].area;
    Element e{.pair = pair,
              .zone = Zone::at(law, m.worst),
              .area = pair.area * (m.triangle < triangles ? 0.5 : 1),
              .shear = law.shear,
              .foot = {m.foot[0], m.foot[1], m.foot[2]},
              .inverse_metric = {},
              .met = {m.met[0], m.met[1]},
              .rest = pair.xi + law.rest * dhat};
    e.inverse_metric = plane(e, s.x).metric().inverse();
    return e;
  }

  TAPE_HD Stencil<6> stencil(int i) const {
    const int(&v)[6] = elements[i].pair.v;
    return {{v[0], v[1], v[2], v[3], v[4], v[5]}};
  }
  TAPE_HD Real energy(const StateView& s, int i) const {
    const Element& e = elements[i];
    return e.area * e.zone.work(Opening(e, plane(e, s.x)).delta());
  }
  TAPE_HD VecN<18> gradient(const StateView& s, int i) const {
    const Element& e = elements[i];
    const auto at = plane(e, s.x);
    const Opening o(e, at);
    return e.area * e.zone.slope(o.delta()) * square_gradient(e, at, o);
  }
  /// `projected` takes the secant's stiffness and drops the curvature of height and slip: what stays are squares.
  TAPE_HD MatN<18, 18> hessian(const StateView& s, int i, HessianMode mode) const {
    const Element& e = elements[i];
    const auto at = plane(e, s.x);
    const Opening o(e, at);
    const Real slope = e.area * e.zone.slope(o.delta());
    const MatN<18, 2> J = at.slope();
    MatN<18, 18> h = 2 * slope * e.shear * J * e.inverse_metric * J.transpose();
    if (o.open > 0) {
      const VecN<18> g = height_gradient(at, o);
      h += 2 * slope * g * g.transpose();
    }
    if (mode == HessianMode::projected) return h;
    at.add_curvature(2 * slope * e.shear * o.slipped, h);
    if (o.open > 0) {  // 2 slope open d2h/dx2, by h^2 = |r|^2 - c^T G^-1 c
      const VecN<18> g = height_gradient(at, o);
      const Real pull = 2 * slope * o.open / o.height;
      for (int k = 0; k < 6; ++k)
        for (int l = 0; l < 6; ++l) h.block<3, 3>(3 * k, 3 * l).diagonal().array() += pull * at.w[k] * at.w[l];
      h -= pull * (J * e.inverse_metric * J.transpose() + g * g.transpose());
      at.add_curvature(-pull * o.beside, h);
    }
    if (const Real curvature = e.area * e.zone.curvature(o.delta()); curvature != 0) {
      const VecN<18> g = square_gradient(e, at, o);
      h += curvature * g * g.transpose();
    }
    return h;
  }

  /// A sample sticks where it is within reach and the faces that it and the triangle turn to each other adhere.
  TAPE_HD bool begin(const SamplePair& pair, const StateView& s, Memory& out) const {
    const Adhesion& a = s.adhesion[pair.interface];
    if (a.law != of_law) return false;
    const Vec3 x[4] = {pair.point(s.x), s.x[pair.v[3]], s.x[pair.v[4]], s.x[pair.v[5]]};
    const Closest closest = closest_vertex_triangle(x);
    const Vec3 offset = combine(closest.weight, x);
    const Vec3 own = (s.x[pair.v[1]] - s.x[pair.v[0]]).cross(s.x[pair.v[2]] - s.x[pair.v[0]]);
    const Face of_sample = own.dot(offset) > 0 ? Face::sticky : Face::backing;
    const Face of_triangle = (x[2] - x[1]).cross(x[3] - x[1]).dot(offset) < 0 ? Face::sticky : Face::backing;
    if (!a.sticks[static_cast<int>(of_sample)][static_cast<int>(of_triangle)]) return false;
    if (!(offset.norm() <= pair.xi + a.area.reach * dhat)) return false;
    out = {pair.name(), {-closest.weight[1], -closest.weight[2], -closest.weight[3]}, {0, 0}, 0};
    const Vec2 met = TrianglePlane<6>(corners(pair, s.x).x, pair.w, out.foot).along();
    out.met[0] = met[0], out.met[1] = met[1];
    return true;
  }
  TAPE_HD bool renew(const StateView& s, int i, Memory& m) const {
    const Element& e = elements[i];
    m.worst = std::fmax(m.worst, Opening(e, plane(e, s.x)).delta());
    return m.worst < e.zone.final;
  }
  /// What opens on must be known to a fiftieth of the final opening, or errors of the solver tear it.
  TAPE_HD Real accuracy_to_judge(const StateView& s, int i) const {
    const Element& e = elements[i];
    const bool near = Opening(e, plane(e, s.x)).delta() > e.zone.knee / 2;
    return near ? 0.02 * e.zone.final : std::numeric_limits<Real>::infinity();
  }
  TAPE_HD AdhesiveForce force(const StateView& s, int i) const {
    const Element& e = elements[i];
    const auto at = plane(e, s.x);
    const Opening o(e, at);
    const Real pull = 2 * e.area * e.zone.slope(o.delta());
    return {.interface = e.pair.interface,
            .vertex = {e.pair.v[0], e.pair.v[1], e.pair.v[2]},
            .weight = {e.pair.w[0], e.pair.w[1], e.pair.w[2]},
            .live = true,
            .normal = pull * std::fmax(o.open, 0),
            .tangential = pull * e.shear * std::sqrt(o.slip2)};
  }

 private:
  struct Corners {
    Vec3 x[6];
  };
  TAPE_HD static Corners corners(const SamplePair& p, Span<const Vec3> x) {
    Corners out;
    for (int k = 0; k < 6; ++k) out.x[k] = x[p.v[k]];
    return out;
  }
  /// The way from the point that a sample sticks to, in parts.
  struct Opening {
    Vec2 beside;   ///< [1] G^-1 c
    Vec2 slipped;  ///< [1] G^-1 (c - c*)
    Real height;   ///< [m] h
    Real open;     ///< [m] h - d*
    Real slip2;    ///< [m^2] |u|^2
    Real square;   ///< [m^2] delta^2
    TAPE_HD Opening(const Element& e, const TrianglePlane<6>& at) {
      const Vec2 c = at.along();
      beside = e.inverse_metric * c;
      slipped = e.inverse_metric * (c - e.met);
      height = std::sqrt(std::fmax(at.r.squaredNorm() - c.dot(beside), 0));
      open = height - e.rest;
      slip2 = std::fmax((c - e.met).dot(slipped), 0);
      const Real opened = std::fmax(open, 0);
      square = opened * opened + e.shear * slip2;
    }
    TAPE_HD Real delta() const { return std::sqrt(square); }
  };
  TAPE_HD static TrianglePlane<6> plane(const Element& e, Span<const Vec3> x) {
    return TrianglePlane<6>(corners(e.pair, x).x, e.pair.w, e.foot);
  }
  /// grad h, where h > 0.
  TAPE_HD static VecN<18> height_gradient(const TrianglePlane<6>& at, const Opening& o) {
    VecN<18> g = -at.slope() * o.beside;
    for (int k = 0; k < 6; ++k) g.segment<3>(3 * k) += at.w[k] * at.r;
    return g / o.height;
  }
  /// grad delta^2.
  TAPE_HD static VecN<18> square_gradient(const Element& e, const TrianglePlane<6>& at, const Opening& o) {
    VecN<18> g = 2 * e.shear * at.slope() * o.slipped;
    if (o.open > 0) g += 2 * o.open * height_gradient(at, o);
    return g;
  }
};
static_assert(Effect<CohesiveZone>);
}  // namespace tape
