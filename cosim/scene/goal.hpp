#pragma once
#include <string>
#include <vector>

#include "cosim/scene/claim.hpp"
#include "cosim/scene/scene_file.hpp"

namespace cosim {
/// A condition that a scene states: its run succeeds if the claim is true at the end.
struct Goal {
  std::string name;
  Claim claim;
  double held = 0;  ///< [s] before the end, in all of which it must be true
};
/// The list `conditions` of a scene file.
/// @throws InputError "file:line: key = value: reason"
std::vector<Goal> read_goals(const SceneFile& file, const tape::Scene& scene, const RobotScene& robots);
}  // namespace cosim
