#pragma once
#include "cosim/exchange/robots.hpp"
#include "cosim/scene/event.hpp"
#include "cosim/scene/goal.hpp"
#include "cosim/scene/phase.hpp"
#include "cosim/scene/scene_file.hpp"
#include "tape/model/scene.hpp"

namespace cosim {
struct BothWorlds {
  tape::Scene tape;
  RobotScene robots;          ///< whose links are bodies of the other
  std::vector<Event> events;  ///< that the script waits for
  std::vector<Goal> goals;    ///< conditions that it states
  std::vector<Phase> phases;  ///< of the script
};
/// Everything of a scene file that these hold: scene, film, time, contact, gravity, seed, strip or strips, roll, bodies, robots, physics,
/// exchange, materials, interfaces, axles, script, conditions. README.md describes them.
/// @throws InputError "file:line: key = value: reason"
BothWorlds read_worlds(const SceneFile& file);

/// A film out of data/tapes/. @param asked_by  the place that names it
tape::Film load_film(const Reader& asked_by, const std::filesystem::path& scene_file);
}  // namespace cosim
