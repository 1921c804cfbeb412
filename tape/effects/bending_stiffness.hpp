#pragma once
#include <vector>

#include "tape/core/types.hpp"

namespace tape {
/// A triangle of a flat mesh with its neighbours. Edge k is opposite of vertex k.
struct FlatTriangle {
  Vec2 X[3];     ///< [m] counter-clockwise
  Vec2 apex[3];  ///< [m] of the neighbour across edge k
  bool inner[3];
  int edge[3];   ///< id, the same seen from both sides
  Real side[3];  ///< 1 from one side of the edge, -1 from the other

  Vec2 along(int k) const { return X[(k + 2) % 3] - X[(k + 1) % 3]; }
  Real length(int k) const { return along(k).norm(); }
  Vec2 normal(int k) const { return Vec2(along(k).y(), -along(k).x()) / length(k); }      ///< unit, outward
  Real depth(int k, const Vec2& p) const { return (X[(k + 1) % 3] - p).dot(normal(k)); }  ///< [m] of p, inside of edge k
  Real area() const { return depth(0, X[0]) * length(0) / 2; }
  Real neighbour_area(int k) const { return -depth(k, apex[k]) * length(k) / 2; }
};

/// Stiffness K [3x3, 1] of a triangle's bending energy D/2 theta^T K theta over the angles theta at its edges, for plate stiffness
/// D. Rows and columns of free edges are zero. README.md derives both.
Mat3 hinge_stiffness(const FlatTriangle& t);
/// S = sum_k theta_k l_k/(2 A) nu_k nu_k^T, the angle at a free edge being the one that minimises the energy.
Mat3 mean_normal_stiffness(const FlatTriangle& t);
/// K of all triangles of a mesh such that uniform curvature has the plate's energy and is in equilibrium, on any mesh.
/// @param edges  number of edge ids
std::vector<Mat3> plate_stiffness(const std::vector<FlatTriangle>& mesh, int edges);
}  // namespace tape
