#pragma once
#include "robot/model/robot_model.hpp"

namespace robot {
/// Pose X_WL of every link [nj + 1] at the joint positions q [nj, rad or m], with the base at X_WB:
///   X_WC = X_WP X_PJ exp(q),
/// exp(q) the rotation about, or the shift along, the joint's axis in the child's frame. Joints that follow others are not resolved here:
/// see JointMap.
/// @throws InputError if q is not of the model's size
std::vector<Pose> link_poses(const RobotModel& model, const VecX& q, const Pose& X_WB = Pose::Identity());

/// Pose X_WF of a frame, from the poses of all links.
inline Pose frame_pose(const std::vector<Pose>& X_WL, const Frame& frame) { return X_WL[frame.link] * frame.X_LF; }

/// J [6 x nj] of the point p_W [m, world] that moves with a link: [v_W; w_W] = J dq/dt, velocity of the point [m/s] above angular velocity
/// of the link [rad/s], both along the world's axes. Joints that do not carry the link have zero columns.
MatX jacobian(const RobotModel& model, const std::vector<Pose>& X_WL, int link, const Vec3& p_W);
}  // namespace robot
