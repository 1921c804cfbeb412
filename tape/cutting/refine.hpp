#pragma once
#include <vector>

#include "tape/cutting/outline.hpp"

namespace tape {
struct Triangulation {
  std::vector<Vec2> points;  ///< [n] m; those given come first
  std::vector<Index3> triangles;
  Real smallest_angle = 0;  ///< [rad]
};

/// Constrained Delaunay triangulation of the inside of an outline and of `inner` points [m], which stand after those of the outline.
/// Triangles below `angle` [rad] are mended where that is possible: by their circumcentre, or, where that would be too near to a side,
/// by the middle of that side; seams stay whole. No two points come nearer to each other than `shortest` [m].
/// No triangles: the sides cross.  Source: [Ruppert 1995].
Triangulation triangulate(const Outline& outline, const std::vector<Vec2>& inner, Real angle, Real shortest);
}  // namespace tape
