#pragma once
#include <string>
#include <vector>

#include "tape/cutting/blade_line.hpp"
#include "tape/cutting/kerf.hpp"

namespace tape {
struct ProjectParams {
  Real reach = 5e-3;
  Real facing = 0.3;
  template <class F>
  void fields(F&& f) {
    f("reach", reach, "m", Range::positive(), "tape farther than this from the blade is not cut");
    f("facing", facing, "1", Range::closed(0.05, 0.95), "smallest sine of the angle between blade or tape and the direction of the cut");
  }
};

/// A blade as a line in the rest plane of a strip.
struct Projection {
  std::string refusal;         ///< why there is no line; empty: there is
  Line line;                   ///< [m]
  Vec3 normal = Vec3::Zero();  ///< of the plane that was projected on: backing side
  explicit operator bool() const { return refusal.empty(); }
};

/// Where a blade would cut a strip. The triangles that are connected to `targets` within reach of the blade span a plane (mean normal,
/// weighted by area); blade and triangles are projected on it, and each stretch of the blade over a triangle goes to the rest plane by
/// that triangle's corners. Gaps are bridged straight; past an edge of the strip the line goes on straight by at most `overshoot`.
/// Refused: a blade or tape that stands edge-on to the plane, tape that lies there more than once, one above or one beside the other.
/// @param x        [vertices] m, where the strip is
/// @param blade    [k] m, corners of a polyline in the world
/// @param targets  triangles of the strip, such as those under pressure
Projection project_blade(const StripMesh& mesh, const std::vector<Vec3>& x, const std::vector<Vec3>& blade, const std::vector<int>& targets,
                         Real overshoot, const ProjectParams& params);
}  // namespace tape
