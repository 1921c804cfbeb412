#pragma once
#include <numbers>

#include "robot/model/robot_model.hpp"

namespace robot::test {
/// Two links of lengths a and b [m] in the plane z = 0; frame "tip" at the end of the second.
inline RobotModel planar_arm(Real a, Real b) {
  RobotModel model;
  model.name = "planar";
  model.links = {{.name = "base"}, {.name = "upper"}, {.name = "lower"}};
  model.joints = {{.name = "shoulder", .axis = Vec3::UnitZ()},
                  {.name = "elbow", .parent = 1, .X_PJ = Pose(Eigen::Translation3d(a, 0, 0)), .axis = Vec3::UnitZ()}};
  model.frames = {{"tip", 2, Pose(Eigen::Translation3d(b, 0, 0))}};
  return model;
}

/// Seven revolute joints as of a human arm, 0.36 + 0.42 + 0.40 + 0.126 m from base to frame "tool", with limits as lightweight arms have.
inline RobotModel seven_joint_arm() {
  RobotModel model;
  model.name = "seven";
  model.links = {{.name = "base"}};
  const Vec3 axes[7] = {Vec3::UnitZ(), Vec3::UnitY(), Vec3::UnitZ(), -Vec3::UnitY(), Vec3::UnitZ(), Vec3::UnitY(), Vec3::UnitZ()};
  const Real heights[7] = {0.36, 0, 0.21, 0.21, 0.2, 0.2, 0};
  const Real limits[7] = {170, 120, 170, 120, 170, 120, 175};
  for (int k = 0; k < 7; ++k) {
    const Real limit = limits[k] * std::numbers::pi / 180;
    model.links.push_back({.name = "link" + std::to_string(k + 1)});
    model.joints.push_back({.name = "joint" + std::to_string(k + 1),
                            .parent = k,
                            .X_PJ = Pose(Eigen::Translation3d(0, 0, heights[k])),
                            .axis = axes[k],
                            .lower = -limit,
                            .upper = limit,
                            .velocity = 2});
  }
  model.frames = {{"tool", 7, Pose(Eigen::Translation3d(0, 0, 0.126))}};
  return model;
}
}  // namespace robot::test
