#pragma once
#include "tape/effects/barrier.hpp"
#include "tape/effects/barrier_law.hpp"
#include "tape/effects/pair_state.hpp"
#include "tape/math/psd.hpp"
#include "tape/math/rotation.hpp"

namespace tape {
/// Calls f(p, share) for the features of a pair that the barrier counts, and how often. Edge-edge: the closest points, once.
/// Vertex-triangle: neighbouring triangles have edges and vertices in common, so that the sum over all triangles counts a place as often
/// as triangles meet there. Taking the edges off and adding the vertices back counts each place once,
///   sum over triangles - edges between two of them + vertices off the rim        (Euler's formula),
/// and a vertex that slides over a flat surface meets the same barrier everywhere. Each triangle takes its part of what it shares; features
/// that are one place are one call.  Source: [Li 2023], improved max approximation.
template <class F>
TAPE_HD void for_each_feature(const ContactPair& pair, const PairState& at, F&& f) {
  if (pair.kind == PairKind::edge_edge) return f(at, 1.0);
  const Real(&w)[4] = at.closest.weight;
  const bool in_face = at.closest.free == 2;
  if (in_face) f(at, 1.0);
  Real vertex_share[3];
  for (int k = 0; k < 3; ++k) {
    const bool here = at.closest.free == 0 && w[1 + k] != 0;
    vertex_share[k] = (here ? 1.0 : 0.0) + (pair.sharing.vertex[k] > 0 ? 1.0 / pair.sharing.vertex[k] : 0.0);
  }
  PairState feature = at;
  const Real reach2 = (pair.xi + pair.dhat) * (pair.xi + pair.dhat);
  for (int k = 0; k < 3; ++k) {
    const int i = 1 + k, j = 1 + (k + 1) % 3;
    const Real taken = 1 - 1.0 / pair.sharing.edge[k];
    const Vec3 e = at.x[j] - at.x[i], r = at.x[0] - at.x[i];
    const Real s = detail::segment_parameter(e.dot(r), e.squaredNorm());
    if (s <= 0 || s >= 1) {
      vertex_share[s <= 0 ? k : (k + 1) % 3] -= taken;
      continue;
    }
    const bool here = at.closest.free == 1 && w[1 + (k + 2) % 3] == 0;
    const Real share = (here ? 1.0 : 0.0) - taken;
    if (share == 0 || !((r - s * e).squaredNorm() < reach2)) continue;
    feature.move_to(detail::closest_on_segment(0, i, j, s, 1));
    f(feature, share);
  }
  for (int k = 0; k < 3; ++k) {
    if (vertex_share[k] == 0 || !((at.x[0] - at.x[1 + k]).squaredNorm() < reach2)) continue;
    feature.move_to(detail::closest_on_segment(0, 1 + k, 1 + (k + 1) % 3, 0, 1));
    f(feature, vertex_share[k]);
  }
}

TAPE_HD bool Barrier::active(const StateView& s, int i) const {
  if (far_apart(elements[i], s.x, elements[i].xi + elements[i].dhat)) return false;
  const PairState p = PairState::at(elements[i], s.x);
  return reaches(p, elements[i]) && p.fade.value > 0;
}
TAPE_HD bool Barrier::deep(const PairState& p, const ContactPair& pair) { return p.d - pair.xi < 0.1 * pair.dhat; }
TAPE_HD bool Barrier::reaches(const PairState& p, const ContactPair& pair) { return BarrierLaw{1, pair.dhat}.reaches(p.d, pair.xi); }
TAPE_HD Jet Barrier::barrier(const PairState& p, const ContactPair& pair) const {
  return BarrierLaw{pair.kappa, pair.dhat}.at(p.d, pair.xi, pair.weight);
}
TAPE_HD Real Barrier::energy(const StateView& s, int i) const {
  const ContactPair& pair = elements[i];
  if (far_apart(pair, s.x, pair.xi + pair.dhat)) return 0;
  const PairState at = PairState::at(pair, s.x);
  if (!(at.d > pair.xi)) return at.fade.value > 0 ? barrier(at, pair).value : 0;
  Real sum = 0;
  if (reaches(at, pair) && at.fade.value > 0)
    for_each_feature(pair, at, [&](const PairState& p, Real share) { sum += share * p.fade.value * barrier(p, pair).value; });
  return sum;
}
TAPE_HD Real Barrier::normal_force(const PairState& at, const ContactPair& pair) const {
  Real sum = 0;
  for_each_feature(pair, at, [&](const PairState& p, Real share) { sum -= share * barrier(p, pair).slope; });
  return sum;
}
TAPE_HD VecN<12> Barrier::gradient(const StateView& s, int i) const {
  const ContactPair& pair = elements[i];
  VecN<12> g = VecN<12>::Zero();
  for_each_feature(pair, PairState::at(pair, s.x), [&](const PairState& p, Real share) {
    const Jet b = barrier(p, pair);
    g += share * p.fade.value * b.slope * p.gradient();
    if (p.fade.slope != 0) g += p.fade.slope * b.value * 2 * fade_pull(p, p.cross());
  });
  return g;
}
TAPE_HD MatN<12, 12> Barrier::hessian(const StateView& s, int i, HessianMode mode) const {
  const ContactPair& pair = elements[i];
  MatN<12, 12> h = MatN<12, 12>::Zero();
  for_each_feature(pair, PairState::at(pair, s.x), [&](const PairState& p, Real share) {
    const Jet b = barrier(p, pair);
    if (mode == HessianMode::exact) {
      h += share * exact_hessian(p, b);
    } else if (share > 0) {
      h += share * (p.fade.slope != 0 ? faded_projected_hessian(p, b) : projected_hessian(p, b));
      if (deep(p, pair)) p.for_each_saddle([&](Real c, const VecN<12>& v) { h -= share * p.fade.value * b.slope * c * v * v.transpose(); });
    }
  });
  return h;
}
template <class F>
TAPE_HD bool Barrier::squares(const StateView& s, int i, const F& add) const {
  const ContactPair& pair = elements[i];
  const PairState at = PairState::at(pair, s.x);
  if (at.fade.slope != 0) return false;
  for_each_feature(pair, at, [&](const PairState& p, Real share) {
    if (!(share > 0)) return;
    const Jet b = barrier(p, pair);
    add(share * b.curvature, p.gradient());
    if (deep(p, pair)) p.for_each_saddle([&](Real c, const VecN<12>& v) { add(share * -b.slope * c, v); });
  });
  return true;
}
TAPE_HD VecN<12> Barrier::fade_pull(const PairState& p, const Vec3& v) {
  const Vec3 a = (p.x[3] - p.x[2]).cross(v), b = v.cross(p.x[1] - p.x[0]);
  VecN<12> g;
  g << -a, a, -b, b;
  return g;
}
TAPE_HD MatN<12, 12> Barrier::by_vertices(const Mat3& aa, const Mat3& ab, const Mat3& bb) {
  MatN<12, 12> h;
  const Mat3 ba = ab.transpose();
  h << aa, -aa, ab, -ab, -aa, aa, -ab, ab, ba, -ba, bb, -bb, -ba, ba, -bb, bb;
  return h;
}
TAPE_HD MatN<12, 12> Barrier::projected_hessian(const PairState& p, const Jet& b) {
  const Vec3 n = p.normal();
  const Mat3 nn = b.curvature * n * n.transpose();
  MatN<12, 12> h;
  for (int k = 0; k < 4; ++k)
    for (int l = 0; l < 4; ++l) h.block<3, 3>(3 * k, 3 * l) = p.closest.weight[k] * p.closest.weight[l] * nn;
  return h;
}
TAPE_HD MatN<12, 12> Barrier::faded_projected_hessian(const PairState& p, const Jet& b) {
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
TAPE_HD MatN<12, 12> Barrier::exact_hessian(const PairState& p, const Jet& b) {
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
}  // namespace tape
