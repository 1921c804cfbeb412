#pragma once
#include "cosim/scene/reader.hpp"
#include "tape/model/scene.hpp"
#include "tape/model/strip_mesh.hpp"

namespace cosim {
/// Turns the list `script` into scene.grips. Its entries run one after another, in simulated time: moves and waits take time, grips and
/// releases none; `at: t` starts an entry at t, `wait: false` lets a move run beside what follows.
/// @param meshes  [strips of the scene]
void read_script(const Reader& script, const std::vector<tape::StripMesh>& meshes, tape::Scene& scene);
}  // namespace cosim
