#pragma once
#include "robot/model/robot_model.hpp"

namespace robot {
/// A robot that carries a tool for good: the tool's base becomes part of the link that has the frame; its other links and joints follow
/// those of the robot.
/// @param X_FT  of the tool's base in that frame
/// @throws InputError if there is no such frame, or if a link, frame or joint of the tool is named like one of the robot
RobotModel weld(const RobotModel& robot, const std::string& frame, const RobotModel& tool, const Pose& X_FT);
}  // namespace robot
