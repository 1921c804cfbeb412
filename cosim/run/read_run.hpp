#pragma once
#include <map>
#include <string>
#include <vector>

#include "cosim/exchange/robots.hpp"
#include "cosim/run/run_log.hpp"
#include "cosim/scene/goal.hpp"
#include "cosim/scene/scene_file.hpp"

namespace cosim {
/// What a scene file asks for, as far as it concerns the simulation.
struct RunInput {
  SceneFile file;
  Setup setup;
  RobotScene robots;
  std::vector<Event> events;  ///< that the script waits for
  std::vector<Goal> goals;    ///< conditions that the scene states
  std::vector<Phase> phases;  ///< of the script
  RecordParams record;
  std::vector<std::string> figures;
  bool settle_roll = true;           ///< off: a roll starts as it is wound
  std::filesystem::path roll_asset;  ///< empty: none is named
};
/// Reads the scene, the settings of every effect and of the solver, `effects` (switches) and `record`. Whoever reads more
/// sections does so from `file`, then calls its `require_all_used`.
/// @throws InputError "file:line: key = value: reason"
RunInput read_run(SceneFile scene);
}  // namespace cosim
