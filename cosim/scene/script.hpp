#pragma once
#include "cosim/exchange/robots.hpp"
#include "cosim/scene/scene_file.hpp"
#include "tape/model/scene.hpp"
#include "tape/model/strip_mesh.hpp"

namespace cosim {
/// Turns the list `script` into scene.grips. Its entries run one after another, in simulated time: moves and waits take time, grips and
/// releases none; `at: t` starts an entry at t, `wait: false` lets a move run beside what follows.
/// Motions of robots take time as moves do.
/// @param meshes  [strips of the scene]
void read_script(const SceneFile& file, const std::vector<tape::StripMesh>& meshes, tape::Scene& scene, RobotScene& robots);
}  // namespace cosim
