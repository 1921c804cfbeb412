#include "robot/kinematics/joint_map.hpp"

#include <algorithm>
#include <cmath>

namespace robot {
namespace {
/// Joint k is multiplier * (joint `leader`) + offset, and the leader follows no other.
struct Follow {
  int leader;
  Real multiplier, offset;
};
Follow resolve(const RobotModel& model, int k) {
  Follow follow{k, 1, 0};
  for (std::size_t steps = 0; const auto& mimic = model.joints[follow.leader].mimic; ++steps) {
    if (mimic->joint < 0 || mimic->joint >= static_cast<int>(model.joints.size()))
      throw InputError("robot " + model.name + ", joint " + model.joints[k].name + ": the joint that it mimics is none of the robot's");
    if (steps == model.joints.size())
      throw InputError("robot " + model.name + ", joint " + model.joints[k].name + ": follows itself through mimic");
    follow.offset += follow.multiplier * mimic->offset;
    follow.multiplier *= mimic->multiplier;
    follow.leader = mimic->joint;
  }
  return follow;
}

/// Narrows [lower, upper] to the positions of the leader that keep the joint within its limits.
void narrow(const Joint& joint, const Follow& follow, Real& lower, Real& upper) {
  if (follow.multiplier == 0) return;
  Real low = (joint.lower - follow.offset) / follow.multiplier, high = (joint.upper - follow.offset) / follow.multiplier;
  if (low > high) std::swap(low, high);
  lower = std::max(lower, low);
  upper = std::min(upper, high);
}
}  // namespace

JointMap joint_map(const RobotModel& model) {
  const int nj = static_cast<int>(model.joints.size());
  JointMap result;
  std::vector<int> column(nj, -1);
  for (int k = 0; k < nj; ++k) {
    if (model.joints[k].mimic) continue;
    column[k] = static_cast<int>(result.independent.size());
    result.independent.push_back(k);
  }
  const auto nu = static_cast<Eigen::Index>(result.independent.size());
  result.map = MatX::Zero(nj, nu);
  result.offset = VecX::Zero(nj);
  result.lower = VecX::Constant(nu, -std::numeric_limits<Real>::infinity());
  result.upper = -result.lower;
  for (int k = 0; k < nj; ++k) {
    const Follow follow = resolve(model, k);
    const int u = column[follow.leader];
    result.map(k, u) = follow.multiplier;
    result.offset[k] = follow.offset;
    narrow(model.joints[k], follow, result.lower[u], result.upper[u]);
    if (result.lower[u] > result.upper[u])
      throw InputError("robot " + model.name + ", joint " + model.joints[k].name + ": its limits and those of joint " +
                       model.joints[follow.leader].name + ", which it follows, leave no position");
  }
  return result;
}

std::pair<Real, Real> joint_range(const RobotModel& model, int joint) {
  const JointMap map = joint_map(model);
  const auto u = std::ranges::find(map.independent, joint) - map.independent.begin();
  const Joint& own = model.joints[static_cast<std::size_t>(joint)];
  return u < map.lower.size() ? std::pair(map.lower[u], map.upper[u]) : std::pair(own.lower, own.upper);
}
}  // namespace robot
