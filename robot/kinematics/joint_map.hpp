#pragma once
#include "robot/model/robot_model.hpp"

namespace robot {
/// How all joints follow the independent ones:
///   q = map u + offset,   J_u = J map.
/// Chains of joints that follow joints that follow are resolved.
struct JointMap {
  std::vector<int> independent;  ///< [nu] joints that follow no other, in the model's order
  MatX map;                      ///< [nj x nu]
  VecX offset;                   ///< [nj] rad or m
  VecX lower, upper;             ///< [nu] between these every joint, those that follow included, is within its own limits

  VecX all(const VecX& u) const { return map * u + offset; }  ///< [nj]
  VecX independent_of(const VecX& q) const { return q(independent); }
};

/// @throws InputError naming the joint if it follows none of the model's, if joints follow each other in a circle, or if limits leave no
/// position to a joint
JointMap joint_map(const RobotModel& model);

/// [rad or m] between which a joint may be told to be; of one that others follow, so that they are within their limits too.
std::pair<Real, Real> joint_range(const RobotModel& model, int joint);
}  // namespace robot
