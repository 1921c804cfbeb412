#pragma once
#include <functional>

#include "cosim/exchange/robots.hpp"
#include "cosim/scene/scene_file.hpp"

namespace cosim {
/// The sections `robots`, `physics` and `exchange` of a scene file (README.md).
/// @param material  index of a material by name, made if there is none
/// @throws InputError "file:line: key = value: reason"
RobotScene read_robots(const SceneFile& file, const Vec3& gravity, const std::function<int(const std::string&)>& material);

/// How long an entry of the script takes, and where the event stands that ends it before.
struct Lasting {
  Real duration;  ///< [s]
  int* until;
};
/// An entry of the script that names a robot: {robot: arm, joints: {...}}, {robot: hand, posture: pinch}, {robot: arm, frame: flange, by:
/// [...]}, {robot: arm, trajectory: file.csv}. Appends the motion to the robot's.
/// @param expected  [s] when it starts if all events happen at the times `events` [s]
/// @throws InputError also if the motion could not be made then
Lasting add_robot_motion(const Reader& entry, const SceneFile& file, const tape::Moment& start, Real expected,
                         const std::vector<Real>& events, RobotScene& robots);
}  // namespace cosim
