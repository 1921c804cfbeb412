#pragma once
#include "tape/model/scene.hpp"

namespace tape {
/// Pose of the mesh frame of a driven body at time t [s]. Between two waypoints the position moves on a line and the rotation turns
/// about one axis, the short way: R(s) = exp(s log(R1 R0^T)) R0. Before the first and after the last the body rests.
/// Without waypoints it keeps its start velocity, and its angular velocity about the origin of its mesh frame.
Pose driven_pose(const Body& body, Real t);

/// How far [m] the target of a grip has moved at time t [s].
/// @param events  [s] when each has happened (Moment::at)
Vec3 grip_offset(const Grip& grip, Real t, const std::vector<Real>& events = {});
}  // namespace tape
