#pragma once
#include <cmath>

#include "tape/core/types.hpp"

namespace tape {
/// Closest points of a stencil of four vertices, of whatever features: the offset between them is
///   p = sum_i weight[i] x_i,   distance d = |p|,
/// and near here weight = weight + sum_k b_k slope[k] with `free` parameters b that minimise |p|
/// (0: point-point, 1: point-edge, 2: point-plane or edge-edge). All derivatives of d follow from these, without cases.
struct Closest {
  Real weight[4];
  Real slope[2][4];
  int free;
};

/// p = sum_i weight[i] x_i [m], formed from differences so that small distances keep their digits.
TAPE_HD inline Vec3 combine(const Real (&weight)[4], const Vec3 (&x)[4]) {
  return weight[1] * (x[1] - x[0]) + weight[2] * (x[2] - x[0]) + weight[3] * (x[3] - x[0]);
}

namespace detail {
/// Parameter in [0, 1] of the point on segment a-b closest to p.
TAPE_HD inline Real segment_parameter(const Vec3& p, const Vec3& a, const Vec3& b) {
  const Vec3 e = b - a;
  const Real length2 = e.squaredNorm();
  return length2 > 0 ? std::fmin(1.0, std::fmax(0.0, e.dot(p - a) / length2)) : 0.0;
}
}  // namespace detail

/// Closest points of vertex x[0] and triangle x[1] x[2] x[3].
TAPE_HD inline Closest closest_vertex_triangle(const Vec3 (&x)[4]) {
  const Vec3 e1 = x[2] - x[1], e2 = x[3] - x[1], r = x[0] - x[1];
  const Real a = e1.squaredNorm(), b = e1.dot(e2), c = e2.squaredNorm(), u = e1.dot(r), v = e2.dot(r);
  const Real det = e1.cross(e2).squaredNorm();
  const Real s = c * u - b * v, t = a * v - b * u;
  if (s > 0 && t > 0 && s + t < det) {
    const Real beta = s / det, gamma = t / det;
    return {{1, beta + gamma - 1, -beta, -gamma}, {{0, 1, -1, 0}, {0, 1, 0, -1}}, 2};
  }
  Closest best{};
  Real best2 = -1;
  for (int k = 0; k < 3; ++k) {  // the closest point is on the rim
    const int i = 1 + k, j = 1 + (k + 1) % 3;
    const Real f = detail::segment_parameter(x[0], x[i], x[j]);
    const Real d2 = (r - (x[i] - x[1]) - f * (x[j] - x[i])).squaredNorm();
    if (best2 >= 0 && d2 >= best2) continue;
    best2 = d2;
    best = {{1, 0, 0, 0}, {{0, 0, 0, 0}, {0, 0, 0, 0}}, f > 0 && f < 1 ? 1 : 0};
    best.weight[i] = f - 1, best.weight[j] = -f;
    best.slope[0][i] = 1, best.slope[0][j] = -1;
  }
  return best;
}

/// Closest points of edge x[0] x[1] and edge x[2] x[3]. For parallel edges one of the closest pairs, at an end point.
TAPE_HD inline Closest closest_edge_edge(const Vec3 (&x)[4]) {
  const Vec3 ea = x[1] - x[0], eb = x[3] - x[2], r = x[0] - x[2];
  const Real a = ea.squaredNorm(), b = ea.dot(eb), c = eb.squaredNorm(), u = ea.dot(r), v = eb.dot(r);
  const Real det = ea.cross(eb).squaredNorm();
  const Real sn = b * v - c * u, tn = a * v - b * u;
  Closest best{};
  Real best2 = -1;
  if (det > 1e-20 * a * c && sn > 0 && sn < det && tn > 0 && tn < det) {
    const Real s = sn / det, t = tn / det;
    best = {{1 - s, s, t - 1, -t}, {{-1, 1, 0, 0}, {0, 0, 1, -1}}, 2};
    best2 = (r + s * ea - t * eb).squaredNorm();
  }
  for (int k = 0; k < 4; ++k) {  // an end point of one edge against the other edge
    const bool on_a = k < 2;
    const int p = k, i = on_a ? 2 : 0, j = i + 1;
    const Real f = detail::segment_parameter(x[p], x[i], x[j]);
    const Real d2 = ((x[p] - x[i]) - f * (x[j] - x[i])).squaredNorm();
    if (best2 >= 0 && d2 >= best2) continue;
    best2 = d2;
    const Real sign = on_a ? 1 : -1;  // p points from edge b to edge a
    best = {{0, 0, 0, 0}, {{0, 0, 0, 0}, {0, 0, 0, 0}}, f > 0 && f < 1 ? 1 : 0};
    best.weight[p] = sign, best.weight[i] = sign * (f - 1), best.weight[j] = -sign * f;
    best.slope[0][i] = sign, best.slope[0][j] = -sign;
  }
  return best;
}
}  // namespace tape
