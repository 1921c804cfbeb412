#pragma once
#include "apps/movie/params.hpp"
#include "apps/tapesim/commands.hpp"
#include "cosim/run/read_run.hpp"
#include "tape/step/settle.hpp"

namespace tape::tapesim {
/// For a roll that settles: a progress bar, and an end by Ctrl-C.
SettleParams watched_settle();

/// All of a scene file: the simulation, and the pictures of it.
struct SceneInput {
  cosim::RunInput run;
  movie::PictureParams pictures;
};
/// @throws InputError also for keys that nobody knows
SceneInput load_scene(const SceneArguments& arguments);
/// The same, with the world that it describes.
struct LoadedWorld {
  SceneInput input;
  World world;
};
/// Rolls come to rest first, unless only those are wanted that have done so before.
enum class Rolls { settle, as_known };
/// @throws InputError also for figures that do not fit the scene, and for an initial state that cannot be
LoadedWorld load_world(const SceneArguments& arguments, Rolls rolls);
}  // namespace tape::tapesim
