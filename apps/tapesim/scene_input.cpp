#include "apps/tapesim/scene_input.hpp"

#include "cosim/run/figures.hpp"

namespace tape::tapesim {
namespace {
/// What the solver refuses it names by strips and bodies; the file is ours to add.
World build_world(const Setup& setup, const std::string& file) {
  try {
    return World::build(setup);
  } catch (const InputError& e) {
    throw InputError(file + ": " + e.what());
  }
}
}  // namespace

SceneInput load_scene(const SceneArguments& arguments) {
  SceneInput input{cosim::read_run(cosim::SceneFile::load(arguments.scene, arguments.overrides)), {}};
  input.pictures = read_pictures(input.run.file.root());
  input.run.file.require_all_used();
  return input;
}

LoadedWorld load_world(const SceneArguments& arguments) {
  SceneInput input = load_scene(arguments);
  World world = build_world(input.run.setup, arguments.scene);
  try {
    cosim::require_figures(input.run.figures, world);
  } catch (const InputError& e) {
    input.run.file["record"]["figures"].fail(e.what());
  }
  return {std::move(input), std::move(world)};
}
}  // namespace tape::tapesim
