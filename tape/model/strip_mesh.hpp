#pragma once
#include <vector>

#include "tape/model/scene.hpp"

namespace tape {
/// A strip as triangles. Structured patterns number their vertices row by row: row * columns + column, row 0 at the start.
/// `irregular` and meshes with a grid angle number them by x.
struct StripMesh {
  std::vector<Vec2> rest;         ///< [n] m, flat: x in [0, length], y in [-width/2, width/2]
  std::vector<Index3> triangles;  ///< counter-clockwise in the rest plane: normal = backing side
  int rows = 0;                   ///< rows of vertices, counting the crossed pattern's cell centres into the row before them
  int columns = 0;                ///< vertices per row, the largest. Numbered by x: largest difference of two indices in a triangle
};

/// Length [m] of a cell along the strip: cell_length, or that of a square cell, rounded so that whole cells fill the strip.
Real cell_length(const StripParams& params, Real width);

/// @throws InputError if the settings cannot be meshed (such as a grid angle without pattern `same`)
StripMesh make_strip_mesh(const StripParams& params, Real width, int seed);

/// Numbers the vertices by x, then y, so that neighbours stand close together.
/// @returns the new number of each vertex
std::vector<int> number_by_x(StripMesh& mesh);

/// Positions [n] m of the strip at the start: settled ones, or its centreline follows `strip.path` or `strip.winding` and cross-sections
/// stay straight.
/// The centreline keeps its length along the arcs of a path; chords of cells are shorter by the factor sin(a)/a, a = cell/(2 radius).
/// @throws InputError if it settled on another mesh
std::vector<Vec3> place(const StripMesh& mesh, const Strip& strip);

/// [vertices of `whole`] the vertices of what cuts have left of it, which keep their rest positions to the bit; -1: gone
std::vector<int> survivors(const StripMesh& whole, const StripMesh& remnant);

/// Vertices with x in [from, to] m, in order.
std::vector<int> vertices_between(const StripMesh& mesh, Real from, Real to);
/// Vertices within `tolerance` [m] of the first or the last edge of the strip, in order.
std::vector<int> root_vertices(const StripMesh& mesh, Real tolerance);
std::vector<int> tip_vertices(const StripMesh& mesh, Real tolerance);
}  // namespace tape
