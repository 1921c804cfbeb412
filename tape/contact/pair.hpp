#pragma once
#include <cstdint>

#include "tape/core/types.hpp"
#include "tape/math/distance.hpp"

namespace tape {
/// Vertex against triangle (v[0]; v[1..3]) or edge against edge (v[0..1]; v[2..3]).
enum class PairKind : int { vertex_triangle, edge_edge };

/// Orders names by `first`, then `second`.
TAPE_HD inline std::uint64_t pair_key(int first, int second) {
  return static_cast<std::uint64_t>(first) << 32 | static_cast<std::uint64_t>(second);
}
/// Names a vertex-triangle pair.
struct VertexTriangle {
  int vertex, triangle;
  TAPE_HD std::uint64_t key() const { return pair_key(vertex, triangle); }
};
/// Names a sample of a triangle's area and a triangle that it faces. Triangle t has the samples t n^2 ... t n^2 + n^2 - 1, n to a side.
struct SampleTriangle {
  int sample, triangle;
  TAPE_HD std::uint64_t key() const { return pair_key(sample, triangle); }
};

/// Barycentric coordinates of sample k of a triangle that is cut into n^2 equal ones: the centroid of one of them. Row r, counted from the
/// first corner, holds 2 r + 1 of them: those that stand as the whole does, and upside down in between.
TAPE_HD inline void sample_weights(int k, int n, Real (&w)[3]) {
  int r = 0;
  while ((r + 1) * (r + 1) <= k) ++r;
  const int place = k - r * r, column = place / 2;
  const bool turned = place % 2 == 1;
  w[2] = (column + (turned ? 2.0 : 1.0) / 3) / n;
  w[0] = 1 - (r + (turned ? 1.0 : 2.0) / 3) / n;
  w[1] = 1 - w[0] - w[2];
}

/// Which of a triangle's edges and vertices other triangles have too: the barrier must count each place of a surface once.
struct Sharing {
  std::uint16_t edge[3] = {1, 1, 1};    ///< triangles at the edge from vertex k to k + 1
  std::uint16_t vertex[3] = {0, 0, 0};  ///< triangles around vertex k, 0 on an open rim
};

/// Two surface primitives that may touch. Its constants come with it, so that effects need no tables.
struct ContactPair {
  using Name = VertexTriangle;
  int v[4];  ///< vertices
  PairKind kind;
  int interface;      ///< material of the first primitive times the number of materials, plus that of the second
  Real xi;            ///< [m]   sum of the half-thicknesses: surfaces touch at this distance
  Real dhat;          ///< [m]   reach of the barrier beyond xi
  Real kappa;         ///< [Pa]  stiffness of the barrier
  Real weight;        ///< [m^2] surface that the pair stands for
  Real mollifier;     ///< [m^4] edge-edge: 1e-3 |ea|^2 |eb|^2 at rest; below this squared cross product the pair fades out
  Sharing sharing;    ///< of the triangle
  int triangle = -1;  ///< id of the triangle; -1: edges
  TAPE_HD VertexTriangle name() const { return {v[0], triangle}; }  ///< of a vertex-triangle pair
};

/// A point inside a triangle, which stands for a piece of its area, and another triangle.
struct SamplePair {
  using Name = SampleTriangle;
  int v[6];       ///< vertices of the sample's triangle, of the other
  Real w[3];      ///< [1] barycentric coordinates of the sample
  int interface;  ///< material of the sample times the number of materials, plus that of the other triangle
  Real xi;        ///< [m]   sum of the half-thicknesses
  Real area;      ///< [m^2] at rest
  SampleTriangle id;
  TAPE_HD SampleTriangle name() const { return id; }
  TAPE_HD Vec3 point(Span<const Vec3> x) const { return w[0] * x[v[0]] + w[1] * x[v[1]] + w[2] * x[v[2]]; }
};

TAPE_HD inline Closest closest(PairKind kind, const Vec3 (&x)[4]) {
  return kind == PairKind::vertex_triangle ? closest_vertex_triangle(x) : closest_edge_edge(x);
}
}  // namespace tape
