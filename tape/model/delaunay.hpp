#pragma once
#include <vector>

#include "tape/core/types.hpp"

namespace tape {
/// Triangles (counter-clockwise) that cover the convex hull of `points` [n] m. Their shapes are poor: see flip_to_delaunay.
/// Points on one straight side of the hull must be collinear up to rounding.
std::vector<Index3> triangulate_hull(const std::vector<Vec2>& points);

/// Flips inner edges until each is Delaunay in the plane of `metric` [n] m, a slightly deformed copy of `points` [n] m: of two
/// diagonals that are equally good in `points`, the deformation chooses. Boundary edges stay.
void flip_to_delaunay(const std::vector<Vec2>& points, const std::vector<Vec2>& metric, std::vector<Index3>& triangles);
}  // namespace tape
