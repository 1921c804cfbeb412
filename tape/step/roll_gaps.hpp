#pragma once
#include <limits>
#include <vector>

#include "tape/bodies/assembly.hpp"
#include "tape/contact/surface.hpp"

namespace tape {
/// Gaps from the vertices of some wound rows to what these rows lie on.
struct GapsBelow {
  Real largest = 0;  ///< [m] infinite where it is far beyond dhat
  int vertices = 0;
  int apart = 0;  ///< of these, with nothing to stick to: their gap is above dhat
};
/// How close a wound strip is to its hub and to itself at the start: true distances of the triangles, whose chords cut into the spiral,
/// less the half-thicknesses. The first turn leaves the hub where it climbs over the start of the tape.
struct RollGaps {
  Real smallest = std::numeric_limits<Real>::infinity();  ///< [m] of all pairs of vertex and triangle, edge and edge
  GapsBelow hub;                                          ///< of the first turn to the hub
  GapsBelow layers;                                       ///< of the others to the layer below
};

/// Assumes that nothing intersects.
/// @param x      [nv] m
/// @param strip  index of a wound strip
RollGaps roll_gaps(const Scene& scene, const Assembly& assembly, const SurfaceMesh& surface, const std::vector<Vec3>& x, int strip);

/// Requires that the layers of every roll stand clear of each other and of the hub.
/// @throws InputError naming the turns and rows that do not, their distance and what to change
void check_rolls(const Scene& scene, const Assembly& assembly, const SurfaceMesh& surface, const std::vector<Vec3>& x);
}  // namespace tape
