#pragma once
#include "tape/contact/pair.hpp"
#include "tape/math/mollifier.hpp"

namespace tape {
/// Whether a pair is farther apart than `reach` [m] along its common normal, that of the triangle or of both edges: then so are its closest
/// points. Most candidates are, and need no more.
TAPE_HD inline bool far_apart(const ContactPair& pair, Span<const Vec3> x, Real reach) {
  const Vec3 &a = x[pair.v[0]], &b = x[pair.v[1]], &c = x[pair.v[2]], &d = x[pair.v[3]];
  const bool face = pair.kind == PairKind::vertex_triangle;
  const Vec3 normal = face ? (c - b).cross(d - b) : (b - a).cross(d - c), offset = face ? a - b : a - c;
  const Real height = normal.dot(offset);
  return height * height > reach * reach * normal.squaredNorm();
}

/// A contact pair at a configuration: its closest points, or those of one of its features, and how parallel its edges are.
struct PairState {
  Vec3 x[4];
  Closest closest;
  Vec3 offset;  ///< [m] between the closest points
  Real d;       ///< [m]
  Jet fade;     ///< mollifier; 1 for vertex-triangle pairs

  TAPE_HD static PairState at(const ContactPair& pair, Span<const Vec3> positions) {
    PairState p;
    for (int k = 0; k < 4; ++k) p.x[k] = positions[pair.v[k]];
    p.move_to(tape::closest(pair.kind, p.x));
    p.fade = {1, 0, 0};
    if (pair.kind == PairKind::edge_edge) p.fade = edge_edge_mollifier(p.cross().squaredNorm(), pair.mollifier);
    return p;
  }
  TAPE_HD void move_to(const Closest& points) {
    closest = points;
    offset = combine(points.weight, x);
    d = offset.norm();
  }
  TAPE_HD Vec3 cross() const { return (x[1] - x[0]).cross(x[3] - x[2]); }  ///< [m^2] of the two edges
  TAPE_HD Vec3 normal() const { return offset / d; }

  /// grad d [1]: with closest-point weights w and unit normal n, w (x) n for all features.
  TAPE_HD VecN<12> gradient() const {
    const Vec3 n = normal();
    VecN<12> g;
    for (int k = 0; k < 4; ++k) g.segment<3>(3 * k) = closest.weight[k] * n;
    return g;
  }
  /// Hessian [N/m] of an energy of the distance with this slope [N] and curvature [N/m].
  TAPE_HD MatN<12, 12> hessian(Real slope, Real curvature) const {
    const VecN<12> g = gradient();
    return slope / d * half_square_hessian() + (curvature - slope / d) * g * g.transpose();
  }

 private:
  /// H_D of D = d^2/2 minimised over the free parameters of the closest points, W^T W - Q S^-1 Q^T: d/dx of W^T p where the free
  /// parameters stay optimal.
  TAPE_HD MatN<12, 12> half_square_hessian() const {
    const Closest& c = closest;
    MatN<12, 2> Q = MatN<12, 2>::Zero();
    Vec3 e[2];  // motion of the offset with each free parameter
    for (int f = 0; f < c.free; ++f) {
      e[f] = combine(c.slope[f], x);
      for (int k = 0; k < 4; ++k) Q.block<3, 1>(3 * k, f) = c.slope[f][k] * offset + c.weight[k] * e[f];
    }
    MatN<12, 12> h;
    for (int k = 0; k < 4; ++k)
      for (int l = 0; l < 4; ++l) h.block<3, 3>(3 * k, 3 * l) = c.weight[k] * c.weight[l] * Mat3::Identity();
    if (c.free == 1) h -= Q.col(0) * Q.col(0).transpose() / e[0].squaredNorm();
    if (c.free == 2) {
      const Real a = e[0].squaredNorm(), b = e[0].dot(e[1]), det = e[0].cross(e[1]).squaredNorm();
      const VecN<12> q0 = (e[1].squaredNorm() * Q.col(0) - b * Q.col(1)) / det, q1 = (a * Q.col(1) - b * Q.col(0)) / det;
      h -= q0 * Q.col(0).transpose() + q1 * Q.col(1).transpose();
    }
    return h;
  }
};
}  // namespace tape
