#pragma once
#include <vector>

#include "tape/contact/surface.hpp"

namespace tape {
/// Refuses a start where one object lies wholly inside another: nothing crosses then, and the barrier would keep it in.
/// By the winding number of the outer surface about a vertex of the inner object [Jacobson 2013]; open surfaces enclose nothing.
/// Assumes that no surfaces intersect.
/// @param x  [nv] m
/// @throws InputError naming both objects
void check_nothing_inside(const std::vector<Vec3>& x, const SurfaceMesh& mesh);
}  // namespace tape
