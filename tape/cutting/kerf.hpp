#pragma once
#include <string>
#include <vector>

#include "tape/cutting/blade_line.hpp"
#include "tape/cutting/place.hpp"

namespace tape {
/// What is removed.
struct Kerf {
  Real width = 1.5e-3;
  Real clearance = 0.2e-3;
  template <class F>
  void fields(F&& f) {
    f("width", width, "m", Range::above(0, 0.02), "width of the kerf");
    f("clearance", clearance, "m", Range::closed(0, 0.02), "least distance of parts that do not touch: more than their thickness");
  }
};

/// What a cut must leave. A *cell* is sqrt(2 area / triangles) of the mesh, the side of a square cell of two triangles.
struct KerfParams {
  Real min_angle = 15;
  Real min_width = 0.05;
  Real tolerance = 0.05;
  Real edge_reach = 0.25;
  template <class F>
  void fields(F&& f) {
    f("min_angle_deg", min_angle, "deg", Range::closed(1, 25), "smallest angle of a new triangle");
    f("min_width", min_width, "cells", Range::closed(1e-3, 0.25), "shortest edge, and narrowest strip that may be left over");
    f("tolerance", tolerance, "cells", Range::closed(1e-3, 0.25), "how closely the blade is followed");
    f("edge_reach", edge_reach, "cells", Range::closed(0.01, 1), "a line that ends nearer to an edge of the strip goes on through it");
  }
};

/// Outcome of a cut. If it was refused, there is a reason and nothing else.
struct Cut {
  std::string refusal;
  StripMesh mesh;                 ///< without the kerf, vertices numbered by x
  int unchanged = 0;              ///< triangles below this were there before, in the same order
  std::vector<Place> parent;      ///< [vertices] where they are in the old mesh; weights exactly 1 and 0 where a vertex survived
  std::vector<int> source;        ///< [triangles] the old triangle that it is, or that its centroid lies in
  std::vector<int> new_vertex;    ///< [old vertices] -1: gone
  std::vector<int> new_triangle;  ///< [old triangles] the same triangle, the same corners in the same order; -1: there is none
  std::vector<int> piece;         ///< [vertices] connected part of the strip, numbered by its first vertex
  int pieces = 0;
  Line line;                ///< [m] that was followed, with its ends moved on through edges
  Real kerf_area = 0;       ///< [m^2] old area less new area
  Real smallest_angle = 0;  ///< [deg] of the patch that was triangulated anew
  Real deviation = 0;       ///< [m] largest distance of a corner of the line from the line that was followed
  explicit operator bool() const { return refusal.empty(); }
};

/// Length [m] of a cell of a strip of any mesh.
Real cell_size(const StripMesh& mesh);

/// Cuts a strip along a line of any shape: removes all that is within width/2 of it (flat at its ends, corners mitred) and triangulates
/// the patch around the kerf anew. The mesh may have been cut before. Triangles away from the kerf stay as they are, to the bit.
/// The rules and what is refused: README.md.
/// @param line    in the rest plane; it may end within the strip or go past its edges
/// @param within  triangle of the piece to cut, -1: all pieces that the line meets
/// @throws InputError if the line is not finite or a setting is out of its range
Cut cut_kerf(const StripMesh& mesh, const Line& line, const Kerf& kerf, const KerfParams& params, int within = -1);
}  // namespace tape
