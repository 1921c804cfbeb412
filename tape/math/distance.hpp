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
/// Parameter in [0, 1] of the point on a segment closest to a point: `along` is the product of the segment with the offset of the
/// point from its start, `length2` its squared length.
TAPE_HD inline Real segment_parameter(Real along, Real length2) { return along <= 0 ? 0.0 : along >= length2 ? 1.0 : along / length2; }
/// Vertex p against the point at f of segment i-j. The offset points to the vertex, or with sign -1 to the segment.
TAPE_HD inline Closest closest_on_segment(int p, int i, int j, Real f, Real sign) {
  Closest out{{0, 0, 0, 0}, {{0, 0, 0, 0}, {0, 0, 0, 0}}, f > 0 && f < 1 ? 1 : 0};
  out.weight[p] = sign, out.weight[i] = sign * (f - 1), out.weight[j] = -sign * f;
  out.slope[0][i] = sign, out.slope[0][j] = -sign;
  return out;
}
/// Index of the smallest of n, the first of equals.
template <int N>
TAPE_HD inline int smallest(const Real (&value)[N]) {
  int best = 0;
  for (int k = 1; k < N; ++k)
    if (value[k] < value[best]) best = k;
  return best;
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
  const Vec3 e3 = x[3] - x[2], r2 = x[0] - x[2], r3 = x[0] - x[3];  // the closest point is on the rim: 1-2, 2-3 or 3-1
  const Real f[3] = {detail::segment_parameter(u, a), detail::segment_parameter(e3.dot(r2), e3.squaredNorm()),
                     detail::segment_parameter(-e2.dot(r3), c)};
  const Real d2[3] = {(r - f[0] * e1).squaredNorm(), (r2 - f[1] * e3).squaredNorm(), (r3 + f[2] * e2).squaredNorm()};
  const int k = detail::smallest(d2);
  return detail::closest_on_segment(0, 1 + k, k == 2 ? 1 : 2 + k, f[k], 1);
}

/// Closest points of edge x[0] x[1] and edge x[2] x[3]. For parallel edges one of the closest pairs, at an end point.
TAPE_HD inline Closest closest_edge_edge(const Vec3 (&x)[4]) {
  constexpr Real kParallel = 1e-20, kNearlyParallel = 1e-8;  // squared sines
  const Vec3 ea = x[1] - x[0], eb = x[3] - x[2], r = x[0] - x[2], n = ea.cross(eb);
  const Real a = ea.squaredNorm(), b = ea.dot(eb), c = eb.squaredNorm(), u = ea.dot(r), v = eb.dot(r), det = n.squaredNorm();
  // The products of dot products are cheap, but cancel to the square of a small angle; those of cross products to the angle,
  // so that the place where nearly parallel edges cross is off by eps / angle. The other parameter follows by projection: then the
  // error of the offset lies across the edges, and is eps.
  const bool nearly_parallel = det <= kNearlyParallel * a * c;
  const Real sn = nearly_parallel ? eb.cross(r).dot(n) : b * v - c * u;
  const Real tn = nearly_parallel ? ea.cross(r).dot(n) : a * v - b * u;
  if (det > kParallel * a * c && sn > 0 && sn < det && tn > 0 && tn < det) {
    const Real s = sn / det, t = detail::segment_parameter(v + s * b, c);
    return {{1 - s, s, t - 1, -t}, {{-1, 1, 0, 0}, {0, 0, 1, -1}}, 2};
  }
  // An end point of one edge against the other edge, in the order of the end points.
  const Vec3 r1 = x[1] - x[2], r3 = x[3] - x[0];
  const Real f[4] = {detail::segment_parameter(v, c), detail::segment_parameter(eb.dot(r1), c), detail::segment_parameter(-u, a),
                     detail::segment_parameter(ea.dot(r3), a)};
  const Real d2[4] = {(r - f[0] * eb).squaredNorm(), (r1 - f[1] * eb).squaredNorm(), (r + f[2] * ea).squaredNorm(),
                      (r3 - f[3] * ea).squaredNorm()};
  const int k = detail::smallest(d2);
  return k < 2 ? detail::closest_on_segment(k, 2, 3, f[k], 1) : detail::closest_on_segment(k, 0, 1, f[k], -1);
}
}  // namespace tape
