#pragma once
#include <vector>

#include "tape/cutting/kerf.hpp"
#include "tape/effects/effects.hpp"

namespace tape {
/// A cut of one strip, as the world's arrays see it.
struct CutInWorld {
  const Cut& cut;
  const StripMesh& old_mesh;
  int first_vertex = 0, first_triangle = 0;      ///< of the strip, before and after
  std::vector<Index3> old_triangles, triangles;  ///< of the world
  std::vector<Vec3> old_x, x;                    ///< [m] of all vertices
  int samples = 1;                               ///< to the side of a triangle, of cohesive zones

  int new_vertex(int v) const;    ///< -1: cut away
  int new_triangle(int t) const;  ///< -1: triangulated anew, or cut away
};

/// What adheres after a cut. Pairs of vertices and triangles that survive stay as they are. Else
/// - what a vertex held on a triangle that was triangulated anew it holds on the nearest new one, if that is no farther away;
/// - a new vertex holds what the corners of the triangle that it lies in held, with the mean of their engagement by barycentric weights,
///   and bonds with the mean of their strain, if half of it was bonded;
/// - new samples of cohesive zones hold as the nearest sample of the old triangle did: as far open and slipped.
/// What was on the kerf is gone.
EffectMemory carried_over(const CutInWorld& cut, const EffectMemory& memory);
}  // namespace tape
