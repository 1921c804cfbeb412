#pragma once
#include <vector>

#include "tape/core/types.hpp"

namespace tape::report {
/// How a film answers to strain in its plane.
struct FilmStiffness {
  Real stretch = 0;  ///< [N/m] E h/(1 - nu^2)
  Real poisson = 0;
};
/// Larger principal membrane tension [N/m] of a flat triangle that was moved: of stretch ((1 - nu) E + nu tr(E) I), E = (F^T F - I)/2.
Real largest_tension(const Vec2 (&rest)[3], const Vec3 (&x)[3], const FilmStiffness& film);
/// Principal strains [1] of a flat triangle that was moved: eigenvalues of (F^T F - I) / 2, the larger one in magnitude, as a magnitude.
Real largest_strain(const Vec2 (&rest)[3], const Vec3 (&x)[3]);
/// Per vertex the largest of its triangles; not a number where a vertex belongs to no strip.
/// @param rest  [nv] m  @param strip_vertices  the first ones are those of strips
std::vector<Real> vertex_strain(const std::vector<Index3>& triangles, const std::vector<Vec2>& rest, const std::vector<Vec3>& x,
                                int strip_vertices);
/// The same of tension.
/// @param film  [nt]
std::vector<Real> vertex_tension(const std::vector<Index3>& triangles, const std::vector<Vec2>& rest, const std::vector<Vec3>& x,
                                 int strip_vertices, const std::vector<FilmStiffness>& film);
}  // namespace tape::report
