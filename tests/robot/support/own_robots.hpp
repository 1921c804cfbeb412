#pragma once
#include <string>
#include <vector>

#include "robot/urdf/read_urdf.hpp"

/// The project's own robots and props, and joints by name.
namespace robot::test {
inline RobotModel own_robot(const std::string& name) { return read_urdf(TAPE_SOURCE_DIR "/data/robots/" + name + ".urdf"); }
inline RobotModel own_prop(const std::string& name) { return read_urdf(TAPE_SOURCE_DIR "/data/props/" + name + ".urdf"); }
/// Where joints stand in the model.
inline std::vector<int> indices(const RobotModel& model, const std::vector<std::string>& joints) {
  std::vector<int> result;
  for (const std::string& name : joints) result.push_back(model.find_joint(name));
  return result;
}
/// Positions of all joints of the model: those of these names as given, the others zero.
inline VecX all_joints(const RobotModel& model, const std::vector<std::string>& joints, const VecX& q) {
  VecX all = VecX::Zero(static_cast<Eigen::Index>(model.joints.size()));
  all(indices(model, joints)) = q;
  return all;
}
}  // namespace robot::test
