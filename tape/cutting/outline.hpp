#pragma once
#include <string>
#include <vector>

#include "tape/cutting/blade_line.hpp"
#include "tape/model/strip_mesh.hpp"

namespace tape {
/// Triangles of a mesh, and their border: material on the left of its edges.
struct Patch {
  std::vector<int> triangles;
  std::vector<Index2> border;
  std::vector<char> held;  ///< [vertices of the mesh] 1: a triangle outside the patch has it
};
Patch make_patch(const StripMesh& mesh, std::vector<int> triangles);

/// What a kerf leaves of a patch: the border of that, made of sides with the material on their left.
struct Outline {
  std::string refusal;       ///< why there is none; empty: there is
  std::vector<Vec2> points;  ///< [k] m
  std::vector<int> vertex;   ///< [k] vertex of the mesh that the point is, -1: none
  std::vector<Index2> sides;
  std::vector<char> seam;  ///< [sides] 1: a triangle outside the patch has it too
  Real removed = 0;        ///< [m^2] area of the patch less that of the outline
};

/// Lengths [m] that an outline must respect.
struct OutlineLimits {
  Real spacing;   ///< of points along its sides
  Real shortest;  ///< edges, and distances between parts of the outline that are not neighbours
  Real hair;      ///< pieces thinner than this count as kerf
};
/// Takes from a patch all that is within width/2 of the line, with mitred corners and flat ends, and divides the sides anew.
/// Held vertices stay, and so do corners; vertices on straight sides need not. Where an edge would be too short, the kerf is widened.
Outline without_kerf(const StripMesh& mesh, const Patch& patch, const Line& line, Real width, const OutlineLimits& limits);
}  // namespace tape
