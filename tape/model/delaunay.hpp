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

/// Triangles (counter-clockwise) of the area on the left of `sides` (pairs of points: loops, counter-clockwise outside and clockwise
/// around holes), with all of `points` [n] m that are in it as corners. Each edge is Delaunay, as far as the sides let it be.
/// @returns no triangles if the sides cross, pass through a point or do not enclose an area
std::vector<Index3> triangulate_inside(const std::vector<Vec2>& points, const std::vector<Index2>& sides);
}  // namespace tape
