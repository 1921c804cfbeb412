#pragma once
#include <string>

#include "robot/model/robot_model.hpp"

namespace robot {
/// How far the links and frames of a robot get from the origin of its base.
struct Reach {
  Real at_zero = 0;          ///< [m] the farthest, with every joint at 0 (mimic joints at their offset)
  std::string farthest;      ///< its name
  Real bound = 0;            ///< [m] nothing gets farther, whatever the joints do: the longest sum of distances between successive frames,
                             ///< sliding joints at the end of their range; infinite if one has no end
  std::string longest_path;  ///< the name at its end
};
Reach reach(const RobotModel& robot);

Real total_mass(const RobotModel& robot);

/// What was understood, as text: the tree with the limits of its joints, mass and shapes of each link, mass and reach of the whole, notes.
std::string describe(const RobotModel& robot);
}  // namespace robot
