#pragma once
#include "cosim/exchange/robots.hpp"
#include "cosim/scene/event.hpp"
#include "cosim/scene/phase.hpp"
#include "cosim/scene/scene_file.hpp"
#include "tape/model/scene.hpp"
#include "tape/model/strip_mesh.hpp"

namespace cosim {
/// What a script asks of whoever watches the run.
struct Script {
  std::vector<Event> events;  ///< of the scene, that it waits for
  std::vector<Phase> phases;  ///< in their order
};
/// Turns the list `script` into scene.grips and motions of the robots. Its entries run one after another, in simulated time: moves and
/// waits take time, grips, releases and phases none; `at: t` starts an entry at t, `wait: false` lets a move run beside what follows.
/// @param meshes  [strips of the scene]
Script read_script(const SceneFile& file, const std::vector<tape::StripMesh>& meshes, tape::Scene& scene, RobotScene& robots);
}  // namespace cosim
