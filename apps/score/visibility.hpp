#pragma once
#include <vector>

#include "apps/score/landmark.hpp"

namespace tape::score {
/// What a camera can see of a hub, and the landmark that a person would mark.
struct Sight {
  cosim::LandmarkKind kind = cosim::LandmarkKind::rim;
  Real share = 0;  ///< [1] of the points of its rim, or of both rims from the side, that are in the picture and not hidden
};

/// Triangles that may stand before a hub.
struct Obstacles {
  std::vector<Vec3> x;                ///< [n] m
  std::vector<Index3> tapes, bodies;  ///< without the hub itself
};

/// From the side, where the inner rim is hidden by its wall or thinner than 2 px, tapes do not count: the landmark is the middle of the
/// core under the tape.
Sight sight_of(const render::Camera& camera, const Hub& hub, const Obstacles& obstacles);
}  // namespace tape::score
