#pragma once
#include <vector>

#include "tape/model/scene.hpp"

namespace tape {
/// A strip as triangles. Structured patterns number their vertices row by row: row * columns + column, row 0 at the start.
struct StripMesh {
  std::vector<Vec2> rest;         ///< [n] m, flat: x in [0, length], y in [-width/2, width/2]
  std::vector<Index3> triangles;  ///< counter-clockwise in the rest plane: normal = backing side
  int rows = 0;                   ///< rows of vertices, counting the crossed pattern's cell centres into the row before them
  int columns = 0;                ///< vertices per row, the largest; unknowns of neighbouring rows stand close in memory
};
/// @throws InputError if the settings cannot be meshed (such as a grid angle without pattern `same`)
StripMesh make_strip_mesh(const StripParams& params, Real width, int seed);

/// Positions [n] m of the strip at the start: its centreline follows `strip.path`, cross-sections stay straight.
std::vector<Vec3> place(const StripMesh& mesh, const Strip& strip);

/// Vertices within `tolerance` [m] of the first or the last edge of the strip, in order.
std::vector<int> root_vertices(const StripMesh& mesh, Real tolerance);
std::vector<int> tip_vertices(const StripMesh& mesh, Real tolerance);
}  // namespace tape
