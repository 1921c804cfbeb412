#pragma once
#include <memory>
#include <string>

#include "robot/urdf/read_urdf.hpp"

/// The project's own robots and props.
namespace robot::test {
inline RobotModel own_robot(const std::string& name) { return read_urdf(TAPE_SOURCE_DIR "/data/robots/" + name + ".urdf"); }
inline RobotModel own_prop(const std::string& name) { return read_urdf(TAPE_SOURCE_DIR "/data/props/" + name + ".urdf"); }
inline std::shared_ptr<const RobotModel> shared(RobotModel model) { return std::make_shared<RobotModel>(std::move(model)); }
}  // namespace robot::test
