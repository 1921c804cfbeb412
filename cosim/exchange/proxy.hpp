#pragma once
#include "robot/model/robot_model.hpp"
#include "tape/model/triangle_mesh.hpp"

namespace cosim {
/// What the tape meets of a link: a closed surface of few triangles for each of its collision shapes, in the link's frame.
struct Proxy {
  tape::TriangleMesh mesh = {};  ///< [m]; empty if the link has no collision shapes
  double error = 0;              ///< [m] farthest that a corner of a shape's convex hull stands out of its surface
};

/// Shapes of at most 500 triangles stay as they are if they are closed, hollows and all. Of any other: the convex hull of the points that
/// lie farthest out in 162 directions, spread over the sphere. Convex ones become one hull where that of them all stands out of them by 0.1
/// mm at most: a capsule drawn as a cylinder and two spheres.
Proxy make_proxy(const robot::Link& link);
}  // namespace cosim
