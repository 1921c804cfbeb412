#include "apps/tapesim/scene_input.hpp"

#include "cosim/run/figures.hpp"

namespace tape::tapesim {
SceneInput load_scene(const SceneArguments& arguments) {
  SceneInput input{cosim::load_run(arguments.scene, arguments.overrides), {}};
  input.pictures = read_pictures(input.run.file.root());
  input.run.file.require_all_used();
  return input;
}

LoadedWorld load_world(const SceneArguments& arguments) {
  SceneInput input = load_scene(arguments);
  World world = World::build(input.run.setup);
  cosim::require_figures(input.run.figures, world);
  return {std::move(input), std::move(world)};
}
}  // namespace tape::tapesim
