#include "robot/kinematics/forward_kinematics.hpp"

#include <fmt/format.h>

namespace robot {
namespace {
Pose joint_motion(const Joint& joint, Real q) {
  if (joint.type == JointType::prismatic) return Pose(Eigen::Translation3d(q * joint.axis));
  return Pose(Eigen::AngleAxisd(q, joint.axis));
}
}  // namespace

std::vector<Pose> link_poses(const RobotModel& model, const VecX& q, const Pose& X_WB) {
  if (q.size() != static_cast<Eigen::Index>(model.joints.size()))
    throw InputError(fmt::format("robot {}: {} joint positions for its {} joints", model.name, q.size(), model.joints.size()));
  std::vector<Pose> X_WL{X_WB};
  X_WL.reserve(model.links.size());
  for (std::size_t k = 0; k < model.joints.size(); ++k) {
    const Joint& joint = model.joints[k];
    X_WL.push_back(X_WL[joint.parent] * joint.X_PJ * joint_motion(joint, q[k]));
  }
  return X_WL;
}

MatX jacobian(const RobotModel& model, const std::vector<Pose>& X_WL, int link, const Vec3& p_W) {
  MatX J = MatX::Zero(6, model.joints.size());
  for (int l = link; l > 0; l = model.joints[l - 1].parent) {
    const Joint& joint = model.joints[l - 1];
    const Vec3 axis = X_WL[l].linear() * joint.axis;
    if (joint.type == JointType::prismatic)
      J.col(l - 1) << axis, Vec3::Zero();
    else
      J.col(l - 1) << axis.cross(p_W - X_WL[l].translation()), axis;
  }
  return J;
}
}  // namespace robot
