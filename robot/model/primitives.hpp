#pragma once
#include "robot/model/robot_model.hpp"

/// Shapes with their closed meshes, centred on the origin of their frame. Round ones are inscribed polyhedra.
namespace robot {
/// @param size  [m] full lengths
Shape box_shape(const Vec3& size, const Pose& X_LS = Pose::Identity());
/// Axis z.
Shape cylinder_shape(Real radius, Real length, const Pose& X_LS = Pose::Identity());
Shape sphere_shape(Real radius, const Pose& X_LS = Pose::Identity());
}  // namespace robot
