#include "robot/model/robot_model.hpp"

namespace robot {
int RobotModel::find_joint(const std::string& joint) const {
  for (std::size_t k = 0; k < joints.size(); ++k)
    if (joints[k].name == joint) return static_cast<int>(k);
  return -1;
}

std::optional<Frame> RobotModel::find_frame(const std::string& frame) const {
  for (std::size_t k = 0; k < links.size(); ++k)
    if (links[k].name == frame) return Frame{frame, static_cast<int>(k), Pose::Identity()};
  for (const Frame& f : frames)
    if (f.name == frame) return f;
  return std::nullopt;
}
}  // namespace robot
