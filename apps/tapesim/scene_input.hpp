#pragma once
#include <functional>

#include "apps/movie/params.hpp"
#include "apps/tapesim/commands.hpp"
#include "cosim/run/read_run.hpp"
#include "tape/step/settle.hpp"

namespace tape::tapesim {
/// For a roll that settles: a progress bar, and an end by Ctrl-C.
SettleParams watched_settle();

/// What is recorded as an episode, where that is asked for: section `record` of a scene.
struct EpisodeParams {
  Real motion_rate = 100;
  Real picture_rate = 30;
  Real pixel_noise = 0;
  template <class F>
  void fields(F&& f) {
    f("motion_rate", motion_rate, "1/s", Range::positive(), "joint positions per second of a synthetic episode; at most one a step");
    f("picture_rate", picture_rate, "1/s", Range::positive(), "landmarks per second of a synthetic episode; at most one a step");
    f("pixel_noise", pixel_noise, "px", Range::closed(0, 100), "standard deviation of its landmarks, drawn by `seed`");
  }
};

/// All of a scene file: the simulation, the pictures of it, and what of it becomes an episode.
struct SceneInput {
  cosim::RunInput run;
  movie::PictureParams pictures;
  EpisodeParams episode;
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
/// A roll that stands as it is wound, because nobody has let it come to rest yet.
bool as_wound(const cosim::RunInput& run, std::size_t strip);
/// @param prepare  may change what was read before the world is built
/// @throws InputError also for figures that do not fit the scene, and for an initial state that cannot be
LoadedWorld load_world(const SceneArguments& arguments, Rolls rolls, const std::function<void(cosim::RunInput&)>& prepare = {});
}  // namespace tape::tapesim
