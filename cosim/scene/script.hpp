#pragma once
#include "cosim/exchange/robots.hpp"
#include "cosim/scene/event.hpp"
#include "cosim/scene/scene_file.hpp"
#include "tape/model/scene.hpp"
#include "tape/model/strip_mesh.hpp"

namespace cosim {
/// Turns the list `script` into scene.grips and motions of the robots. Its entries run one after another, in simulated time: moves and
/// waits take time, grips and releases none; `at: t` starts an entry at t, `wait: false` lets a move run beside what follows.
/// @param meshes  [strips of the scene]
/// @return what it waits for: events of the scene
std::vector<Event> read_script(const SceneFile& file, const std::vector<tape::StripMesh>& meshes, tape::Scene& scene, RobotScene& robots);
}  // namespace cosim
