#pragma once
#include "tape/effects/lagged_slip.hpp"
#include "tape/effects/pair_state.hpp"
#include "tape/math/rotation.hpp"

namespace tape {
/// The way between the lagged points of a pair, and two edges of the pair that turn with it.
struct LaggedSlip::Way {
  Vec3 e[2], r;
  Real w[4], edge[2][4];  ///< r = sum w_k x_k, e_a = sum edge_ak x_k
  TAPE_HD Way(const LaggedSlip& lagged, Span<const Vec3> positions) : r(Vec3::Zero()), edge{{0, 0, 0, 0}, {0, 0, 0, 0}} {
    const bool face = lagged.kind == PairKind::vertex_triangle;
    edge[0][face ? 1 : 0] = edge[1][face ? 1 : 2] = -1;
    edge[0][face ? 2 : 1] = edge[1][3] = 1;
    Vec3 x[4];
    for (int k = 0; k < 4; ++k) x[k] = positions[lagged.v[k]], w[k] = lagged.weight[k];
    for (int k = 1; k < 4; ++k) r += w[k] * (x[k] - x[0]);  // the weights sum to 0; differences keep the digits of a small way
    e[0] = face ? x[2] - x[1] : x[1] - x[0];
    e[1] = face ? x[3] - x[1] : x[3] - x[2];
  }
  /// B.
  TAPE_HD Mat3 basis() const {
    Mat3 B;
    B << e[0], e[1], e[0].cross(e[1]);
    return B;
  }
  /// y.
  TAPE_HD Vec3 along() const { return {e[0].dot(r), e[1].dot(r), e[0].cross(e[1]).dot(r)}; }
  /// dy_c/dx_k.
  TAPE_HD Mat3 slope(int k) const {
    Mat3 d;
    d << w[k] * e[0] + edge[0][k] * r, w[k] * e[1] + edge[1][k] * r,
        w[k] * e[0].cross(e[1]) + edge[0][k] * e[1].cross(r) + edge[1][k] * r.cross(e[0]);
    return d;
  }
  /// h += sum_c g_c d2y_c/dx2.
  TAPE_HD void add_curvature(const Vec3& g, MatN<12, 12>& h) const {
    const auto turn = [](const Real(&a)[4], const Real(&b)[4], int k, int l) { return a[k] * b[l] - b[k] * a[l]; };
    for (int k = 0; k < 4; ++k)
      for (int l = 0; l < 4; ++l) {
        Real both = 0;
        for (int a = 0; a < 2; ++a) both += g[a] * (edge[a][k] * w[l] + w[k] * edge[a][l]);
        h.block<3, 3>(3 * k, 3 * l) +=
            both * Mat3::Identity() +
            g[2] * (turn(edge[0], w, k, l) * skew(e[1]) + turn(w, edge[1], k, l) * skew(e[0]) + turn(edge[1], edge[0], k, l) * skew(r));
      }
  }
};

TAPE_HD LaggedSlip LaggedSlip::at(const ContactPair& pair, const PairState& p, Span<const Vec3> x) {
  LaggedSlip out;
  const Vec3 n = p.normal();
  const Vec3 axis = std::fabs(n.x()) < 0.6 ? Vec3(1, 0, 0) : Vec3(0, 1, 0);
  const Vec3 t = n.cross(axis).normalized();
  for (int k = 0; k < 4; ++k) out.v[k] = pair.v[k], out.weight[k] = p.closest.weight[k];
  out.kind = pair.kind;
  out.T.col(0) = t;
  out.T.col(1) = n.cross(t);
  const Way way(out, x);
  const Mat3 inverse = way.basis().inverse();  // within a product it would be a host function
  out.slip_of = out.T.transpose() * inverse.transpose();
  out.start = way.along();
  out.before.setZero();
  return out;
}
TAPE_HD Vec2 LaggedSlip::slip(SlipFrame frame, const StateView& s) const {
  if (frame == SlipFrame::turning) return before + slip_of * (Way(*this, s.x).along() - start);
  Vec3 u = Vec3::Zero();
  for (int k = 0; k < 4; ++k) u += weight[k] * (s.x[v[k]] - s.x_start[v[k]]);
  return before + T.transpose() * u;
}
TAPE_HD Vec3 LaggedSlip::remembered(const Vec2& u, const StateView& s) const { return Way(*this, s.x_start).basis().transpose() * T * u; }
TAPE_HD Vec2 LaggedSlip::recalled(const Vec3& y) const { return slip_of * y; }
TAPE_HD MatN<12, 2> LaggedSlip::slope(SlipFrame frame, const StateView& s) const {
  MatN<12, 2> J;
  if (frame == SlipFrame::turning) {
    const Way way(*this, s.x);
    for (int k = 0; k < 4; ++k) J.block<3, 2>(3 * k, 0) = way.slope(k) * slip_of.transpose();
  } else {
    for (int k = 0; k < 4; ++k) J.block<3, 2>(3 * k, 0) = weight[k] * T;
  }
  return J;
}
TAPE_HD void LaggedSlip::add_curvature(SlipFrame frame, const StateView& s, const Vec2& g, MatN<12, 12>& h) const {
  if (frame == SlipFrame::turning) Way(*this, s.x).add_curvature(slip_of.transpose() * g, h);
}
}  // namespace tape
