#pragma once
#include <vector>

#include "tape/core/types.hpp"

namespace tape::report {
/// Principal strains [1] of a flat triangle that was moved: eigenvalues of (F^T F - I) / 2, the larger one in magnitude, as a magnitude.
Real largest_strain(const Vec2 (&rest)[3], const Vec3 (&x)[3]);
/// Per vertex the largest of its triangles; not a number where a vertex belongs to no strip.
/// @param rest  [nv] m  @param strip_vertices  the first ones are those of strips
std::vector<Real> vertex_strain(const std::vector<Index3>& triangles, const std::vector<Vec2>& rest, const std::vector<Vec3>& x,
                                int strip_vertices);
}  // namespace tape::report
