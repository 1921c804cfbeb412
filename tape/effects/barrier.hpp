#pragma once
#include "tape/effects/barrier_law.hpp"
#include "tape/effects/effect.hpp"
#include "tape/math/psd.hpp"

namespace tape {
/// Contact barrier of vertex-triangle and edge-edge pairs:  E = sum over features of share m b(d), with the law b of the distance, the
/// mollifier m of edge pairs (1 for vertex-triangle pairs) and the share of for_each_feature (1 for edge pairs).
struct Barrier {
  static constexpr std::string_view name = "barrier";
  static constexpr bool contact_pairs = true;
  using Params = NoParams;
  using Element = ContactPair;
  Span<const Element> elements;
  Real kappa;  ///< [Pa]

  /// A strip can touch itself; bodies touch each other unless all, or all but one, are static.
  static std::string needed(const Scene& scene, const Params&) {
    if (!scene.strips.empty()) return "strip";
    int movable = 0;
    for (const Body& b : scene.bodies) movable += b.motion != Motion::fixed;
    return movable > 0 && scene.bodies.size() > 1 ? "bodies" : "";
  }
  static Barrier build(const Scene& scene, const Assembly&, const Params&, std::vector<Element>&) { return {{}, scene.contact.kappa}; }

  TAPE_HD Stencil<4> stencil(int i) const {
    const int(&v)[4] = elements[i].v;
    return {{v[0], v[1], v[2], v[3]}};
  }
  TAPE_HD bool active(const StateView& s, int i) const {
    if (far_apart(elements[i], s.x, elements[i].xi + elements[i].dhat)) return false;
    const PairState p = PairState::at(elements[i], s.x);
    return reaches(p, elements[i]) && p.fade.value > 0;
  }
  TAPE_HD static bool reaches(const PairState& p, const ContactPair& pair) { return BarrierLaw{1, pair.dhat}.reaches(p.d, pair.xi); }
  TAPE_HD Jet barrier(const PairState& p, const ContactPair& pair) const {
    return BarrierLaw{kappa, pair.dhat}.at(p.d, pair.xi, pair.weight);
  }

  TAPE_HD Real energy(const StateView& s, int i) const {
    const ContactPair& pair = elements[i];
    if (far_apart(pair, s.x, pair.xi + pair.dhat)) return 0;
    const PairState at = PairState::at(pair, s.x);
    if (!(at.d > pair.xi)) return at.fade.value > 0 ? barrier(at, pair).value : 0;
    Real sum = 0;
    if (reaches(at, pair) && at.fade.value > 0)
      for_each_feature(pair, at, [&](const PairState& p, Real share) { sum += share * p.fade.value * barrier(p, pair).value; });
    return sum;
  }
  /// Force [N] that pushes the two primitives apart; that of edge pairs unfaded.
  TAPE_HD Real normal_force(const PairState& at, const ContactPair& pair) const {
    Real sum = 0;
    for_each_feature(pair, at, [&](const PairState& p, Real share) { sum -= share * barrier(p, pair).slope; });
    return sum;
  }
  TAPE_HD VecN<12> gradient(const StateView& s, int i) const {
    const ContactPair& pair = elements[i];
    VecN<12> g = VecN<12>::Zero();
    for_each_feature(pair, PairState::at(pair, s.x), [&](const PairState& p, Real share) {
      const Jet b = barrier(p, pair);
      g += share * p.fade.value * b.slope * p.gradient();
      if (p.fade.slope != 0) g += p.fade.slope * b.value * 2 * fade_pull(p, p.cross());
    });
    return g;
  }
  /// `projected` drops features of negative share: the neighbours' positive ones that they balance stay.
  TAPE_HD MatN<12, 12> hessian(const StateView& s, int i, HessianMode mode) const {
    const ContactPair& pair = elements[i];
    MatN<12, 12> h = MatN<12, 12>::Zero();
    for_each_feature(pair, PairState::at(pair, s.x), [&](const PairState& p, Real share) {
      const Jet b = barrier(p, pair);
      if (mode == HessianMode::exact) {
        h += share * exact_hessian(p, b);
      } else if (share > 0) {
        h += share * (p.fade.slope != 0 ? faded_projected_hessian(p, b) : projected_hessian(p, b));
      }
    });
    return h;
  }

  template <class F>
  TAPE_HD bool squares(const StateView& s, int i, const F& add) const {
    const ContactPair& pair = elements[i];
    const PairState at = PairState::at(pair, s.x);
    if (at.fade.slope != 0) return false;
    for_each_feature(pair, at, [&](const PairState& p, Real share) {
      if (share > 0) add(share * barrier(p, pair).curvature, p.gradient());
    });
    return true;
  }

 private:
  /// J^T v with J = d(ea x eb)/dx; that of c = |ea x eb|^2 is 2 J^T (ea x eb).
  TAPE_HD static VecN<12> fade_pull(const PairState& p, const Vec3& v) {
    const Vec3 a = (p.x[3] - p.x[2]).cross(v), b = v.cross(p.x[1] - p.x[0]);
    VecN<12> g;
    g << -a, a, -b, b;
    return g;
  }
  /// Matrix by (ea, eb) -> by the four vertices.
  TAPE_HD static MatN<12, 12> by_vertices(const Mat3& aa, const Mat3& ab, const Mat3& bb) {
    MatN<12, 12> h;
    const Mat3 ba = ab.transpose();
    h << aa, -aa, ab, -ab, -aa, aa, -ab, ab, ba, -ba, bb, -bb, -ba, ba, -bb, bb;
    return h;
  }

  /// b'' grad d (grad d)^T; b is convex. The curvature of d itself has the factor b' <= 0: for two points it is negative and the
  /// projection drops all of it, for the other features nearly all.
  TAPE_HD static MatN<12, 12> projected_hessian(const PairState& p, const Jet& b) {
    const Vec3 n = p.normal();
    const Mat3 nn = b.curvature * n * n.transpose();
    MatN<12, 12> h;
    for (int k = 0; k < 4; ++k)
      for (int l = 0; l < 4; ++l) h.block<3, 3>(3 * k, 3 * l) = p.closest.weight[k] * p.closest.weight[l] * nn;
    return h;
  }
  /// In s = |ea x eb| the product is m(s) b(d): its 2x2 Hessian by (s, d) is clamped, and the curvature of s, which is that of
  /// the length of a vector along the cross product's change, stays. The clamp scales s as if |grad s| were |grad d|.
  TAPE_HD static MatN<12, 12> faded_projected_hessian(const PairState& p, const Jet& b) {
    const Vec3 v = p.cross();
    const Real c = v.squaredNorm();
    if (!(c > 0)) return MatN<12, 12>::Zero();
    const Vec3 u = v / std::sqrt(c), ea = p.x[1] - p.x[0], eb = p.x[3] - p.x[2];
    const VecN<12> gs = fade_pull(p, u), gd = p.gradient();
    const Real scale = std::sqrt(gs.squaredNorm() / gd.squaredNorm()), m_s = 2 * std::sqrt(c) * p.fade.slope;
    Mat2 product;
    product(0, 0) = (2 * p.fade.slope + 4 * c * p.fade.curvature) * b.value * scale * scale;
    product(0, 1) = product(1, 0) = m_s * b.slope * scale;
    product(1, 1) = p.fade.value * b.curvature;
    const Mat2 clamped = psd_part(product);
    const Mat3 across = 2 * p.fade.slope * b.value * (Mat3::Identity() - u * u.transpose()), ka = skew(ea), kb = skew(eb);
    MatN<12, 12> h = by_vertices(-kb * across * kb, kb * across * ka, -ka * across * ka);
    const VecN<12> ss = gs / scale;
    h += ss * (clamped(0, 0) * ss + clamped(0, 1) * gd).transpose() + gd * (clamped(1, 0) * ss + clamped(1, 1) * gd).transpose();
    return h;
  }

  TAPE_HD static MatN<12, 12> exact_hessian(const PairState& p, const Jet& b) {
    const VecN<12> gd = p.gradient();
    const Real m = p.fade.value;
    MatN<12, 12> h = m * p.hessian(b.slope, b.curvature);
    if (p.fade.slope == 0) return h;
    const Vec3 v = p.cross();
    const VecN<12> gc = 2 * fade_pull(p, v);
    const Mat3 ka = skew(p.x[1] - p.x[0]), kb = skew(p.x[3] - p.x[2]);
    h += p.fade.curvature * b.value * gc * gc.transpose();
    h += p.fade.slope * b.slope * (gc * gd.transpose() + gd * gc.transpose());
    h += 2 * p.fade.slope * b.value * by_vertices(-kb * kb, kb * ka - skew(v), -ka * ka);
    return h;
  }
};
static_assert(Effect<Barrier>);
}  // namespace tape
