#pragma once
#include "tape/effects/effect.hpp"

namespace tape {
struct Jet;
struct PairState;

/// Contact barrier of vertex-triangle and edge-edge pairs:  E = sum over features of share m b(d), with the law b of the distance, the
/// mollifier m of edge pairs (1 for vertex-triangle pairs) and the share of for_each_feature (1 for edge pairs).
struct Barrier {
  static constexpr std::string_view name = "barrier";
  static constexpr bool contact_pairs = true;
  using Params = NoParams;
  using Element = ContactPair;
  Span<const Element> elements;

  /// A strip can touch itself; bodies touch each other unless all, or all but one, are static.
  static std::string needed(const Scene& scene, const Params&) {
    if (!scene.strips.empty()) return "strip";
    int movable = 0;
    for (const Body& b : scene.bodies) movable += b.motion != Motion::fixed;
    return movable > 0 && scene.bodies.size() > 1 ? "bodies" : "";
  }
  static Barrier build(const Scene&, const Assembly&, const Params&, std::vector<Element>&) { return {}; }

  TAPE_HD Stencil<4> stencil(int i) const {
    const int(&v)[4] = elements[i].v;
    return {{v[0], v[1], v[2], v[3]}};
  }
  TAPE_HD inline bool active(const StateView& s, int i) const;
  TAPE_HD static inline bool reaches(const PairState& p, const ContactPair& pair);
  TAPE_HD inline Jet barrier(const PairState& p, const ContactPair& pair) const;

  TAPE_HD inline Real energy(const StateView& s, int i) const;
  /// Force [N] that pushes the two primitives apart; that of edge pairs unfaded.
  TAPE_HD inline Real normal_force(const PairState& at, const ContactPair& pair) const;
  TAPE_HD inline VecN<12> gradient(const StateView& s, int i) const;
  /// `projected` drops features of negative share: the neighbours' positive ones that they balance stay.
  TAPE_HD inline MatN<12, 12> hessian(const StateView& s, int i, HessianMode mode) const;

  template <class F>
  TAPE_HD inline bool squares(const StateView& s, int i, const F& add) const;

 private:
  /// J^T v with J = d(ea x eb)/dx; that of c = |ea x eb|^2 is 2 J^T (ea x eb).
  TAPE_HD static inline VecN<12> fade_pull(const PairState& p, const Vec3& v);
  /// Matrix by (ea, eb) -> by the four vertices.
  TAPE_HD static inline MatN<12, 12> by_vertices(const Mat3& aa, const Mat3& ab, const Mat3& bb);

  /// Whether the force is so large that the curvature of d matters, which has the factor b' <= 0: a pair that slides along itself and tilts
  /// comes closer than its tangents foresee. Without that a pair this deep is driven deeper by each update, and CCD lets through
  /// less each time. Elsewhere it makes rolls stiff: their layers do slide and tilt, as one.
  TAPE_HD static inline bool deep(const PairState& p, const ContactPair& pair);
  /// b'' grad d (grad d)^T; b is convex. Of the curvature of d itself only `deep` pairs have a part, that of for_each_saddle.
  TAPE_HD static inline MatN<12, 12> projected_hessian(const PairState& p, const Jet& b);
  /// In s = |ea x eb| the product is m(s) b(d): its 2x2 Hessian by (s, d) is clamped, and the curvature of s, which is that of
  /// the length of a vector along the cross product's change, stays. The clamp scales s as if |grad s| were |grad d|.
  TAPE_HD static inline MatN<12, 12> faded_projected_hessian(const PairState& p, const Jet& b);

  TAPE_HD static inline MatN<12, 12> exact_hessian(const PairState& p, const Jet& b);
};
static_assert(Effect<Barrier>);
}  // namespace tape
