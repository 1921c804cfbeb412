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
  /// Calls f(c, v) with the positive part, sum c v v^T [1/m], of minus the Hessian of d: what brings a pair that slides along itself and
  /// tilts closer than its tangents foresee. With the slopes s_a of the weights by the free parameters and the tangents t_a, made
  /// orthonormal,
  ///   -hess d = sum_a (p_a q_a^T + q_a p_a^T + d p_a p_a^T) - sum_b q_b q_b^T / d,   p_a = s_a (x) n,  q = w (x) t,
  /// where b counts the tangents without a parameter. All p and q are orthogonal if s_1 and s_2 are.
  template <class F>
  TAPE_HD void for_each_saddle(F&& f) const {
    Vec3 t[2];
    Eigen::Matrix<Real, 4, 1> s[2], w;
    for (int k = 0; k < 4; ++k) w[k] = closest.weight[k];
    for (int a = 0; a < closest.free; ++a) {
      t[a] = combine(closest.slope[a], x);
      for (int k = 0; k < 4; ++k) s[a][k] = closest.slope[a][k];
      if (a == 1) s[1] -= t[0].dot(t[1]) * s[0], t[1] -= t[0].dot(t[1]) * t[0];
      const Real length = t[a].norm();
      if (!(length > 0)) return;
      t[a] /= length, s[a] /= length;
    }
    if (closest.free == 2) {  // turned about the normal until the slopes are orthogonal too
      const Real angle = 0.5 * std::atan2(2 * s[0].dot(s[1]), s[0].squaredNorm() - s[1].squaredNorm()), c = std::cos(angle),
                 z = std::sin(angle);
      const Vec3 t0 = c * t[0] + z * t[1];
      const Eigen::Matrix<Real, 4, 1> s0 = c * s[0] + z * s[1];
      t[1] = c * t[1] - z * t[0], s[1] = c * s[1] - z * s[0];
      t[0] = t0, s[0] = s0;
    }
    const Vec3 n = normal();
    const Real size = w.norm();
    for (int a = 0; a < closest.free; ++a) {
      const Real tilt = s[a].norm(), product = tilt * size, square = d * tilt * tilt;
      if (!(tilt > 0)) continue;
      const Real c = (square + std::sqrt(square * square + 4 * product * product)) / 2, scale = 1 / std::sqrt(c * c + product * product);
      VecN<12> v;
      for (int k = 0; k < 4; ++k) v.segment<3>(3 * k) = scale * (c / tilt * s[a][k] * n + product / size * w[k] * t[a]);
      f(c, v);
    }
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
