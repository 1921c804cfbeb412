#pragma once
#include <cmath>

#include "tape/effects/effect.hpp"

namespace tape {
template <int K>
struct TrianglePlane;

/// Cohesive adhesion by area, law `per_area`: every triangle of a strip is cut into n^2 pieces, and the sample in the middle of each sticks
/// to the point of another triangle that is nearest when they meet. With the height h of the sample over the triangle's plane, its height
/// d* at rest and the slip u in the plane,
///   E = area phi(delta),   delta^2 = max(h - d*, 0)^2 + r |u|^2,   phi' the traction of AreaCohesion.
/// Up to the largest opening that was ever reached at the end of a step the traction runs back along its secant: what was torn stays
/// torn, and the work of separation does not depend on dt. Beyond it softens within the step.
/// With c_a = e_a.r along the triangle's edges (TrianglePlane), and their metric G when the step started, h^2 = |r|^2 - c^T G^-1 c and
/// |u|^2 = (c - c*)^T G^-1 (c - c*), c* when they met. README.md says why.
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
    Real share;    ///< [1] of its area that it carries: half where the other side's samples carry the rest
    Real engagement(const Adhesion& a) const { return Zone::at(a.area, worst).secant / Zone::at(a.area, 0).secant; }
    template <class F>
    void visit(F&& f) {
      f(sample), f(triangle), f(foot[0]), f(foot[1]), f(foot[2]), f(met[0]), f(met[1]), f(worst), f(share);
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
  TAPE_HD inline Element recall(const Memory& m, const SamplePair& pair, const StateView& s) const;

  TAPE_HD Stencil<6> stencil(int i) const {
    const int(&v)[6] = elements[i].pair.v;
    return {{v[0], v[1], v[2], v[3], v[4], v[5]}};
  }
  TAPE_HD inline Real energy(const StateView& s, int i) const;
  TAPE_HD inline VecN<18> gradient(const StateView& s, int i) const;
  /// `projected` takes the secant's stiffness and drops the curvature of height and slip: what stays are squares.
  TAPE_HD inline MatN<18, 18> hessian(const StateView& s, int i, HessianMode mode) const;
  template <class F>
  TAPE_HD inline bool squares(const StateView& s, int i, const F& add) const;

  /// A sample sticks where it is within reach and the faces that it and the triangle turn to each other adhere.
  TAPE_HD inline bool begin(const SamplePair& pair, const StateView& s, Memory& out) const;
  TAPE_HD inline bool renew(const StateView& s, int i, Memory& m) const;
  /// What opens on must be known to a fiftieth of the final opening, or errors of the solver tear it.
  TAPE_HD inline Real accuracy_to_judge(const StateView& s, int i) const;
  /// To where traction softens.
  TAPE_HD inline Real slack(const StateView& s, int i) const;
  TAPE_HD inline AdhesiveForce force(const StateView& s, int i) const;

 private:
  struct Corners;
  struct Opening;
  TAPE_HD static inline Corners corners(const SamplePair& p, Span<const Vec3> x);
  TAPE_HD static inline TrianglePlane<6> plane(const Element& e, Span<const Vec3> x);
  /// grad h, where h > 0.
  TAPE_HD static inline VecN<18> height_gradient(const TrianglePlane<6>& at, const Opening& o);
  /// grad delta^2.
  TAPE_HD static inline VecN<18> square_gradient(const Element& e, const TrianglePlane<6>& at, const Opening& o);
};
static_assert(Effect<CohesiveZone>);
}  // namespace tape
