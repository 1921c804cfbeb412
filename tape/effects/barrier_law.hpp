#pragma once
#include <cmath>
#include <limits>

#include "tape/effects/pair_state.hpp"

namespace tape {
/// Barrier energy of a pair at distance d:  b(d) = w dhat/4 kappa (r - 1)^2 ln(r)^2,  r = (d^2 - xi^2)/(dhat^2 + 2 dhat xi),
/// infinite at contact (d = xi) and C1 zero from d = xi + dhat on.  Source: [Huang 2024], offset by thickness as in [Li 2021].
struct BarrierLaw {
  Real kappa;  ///< [Pa]
  Real dhat;   ///< [m]
  TAPE_HD bool reaches(Real d, Real xi) const { return d < xi + dhat; }
  /// Energy [J], slope [N] and curvature [N/m] at distance d [m] of a pair with offset xi [m] and weight w [m^2].
  TAPE_HD Jet at(Real d, Real xi, Real weight) const {
    if (!reaches(d, xi)) return {0, 0, 0};
    if (!(d > xi)) return {std::numeric_limits<Real>::infinity(), 0, 0};  // a trial step that the line search refuses
    const Real band = dhat * (dhat + 2 * xi), r = (d - xi) * (d + xi) / band;
    const Real scale = weight * dhat / 4 * kappa, l = std::log(r), a = r - 1;
    const Real slope = 2 * a * l * (l + a / r);  // by r
    const Real curvature = 2 * l * l + 8 * a * l / r + 2 * a * a * (1 - l) / (r * r);
    const Real r_d = 2 * d / band;
    return {scale * a * a * l * l, scale * slope * r_d, scale * (curvature * r_d * r_d + slope * 2 / band)};
  }
};

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
}  // namespace tape
