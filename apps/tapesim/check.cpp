#include <fmt/format.h>

#include <memory>

#include "apps/tapesim/scene_input.hpp"

namespace tape::tapesim {
namespace {
int check(const SceneArguments& arguments) {
  const LoadedWorld loaded = load_world(arguments);
  const Scene& scene = loaded.world.setup.scene;
  fmt::print("{}: sound. Strips: {}, bodies: {}, vertices: {}, triangles: {}, unknowns: {}; {} steps of {} s\n", arguments.scene,
             scene.strips.size(), scene.bodies.size(), loaded.world.assembly.surface_vertices, loaded.world.assembly.triangles.size(),
             3 * loaded.world.assembly.blocks, cosim::planned_steps(scene), to_text(scene.time.dt));
  return kDone;
}
}  // namespace

void add_check(CLI::App& app, Action& chosen) {
  auto arguments = std::make_shared<SceneArguments>();
  CLI::App* command = app.add_subcommand("check", "validates a scene, its initial state included, and simulates nothing");
  add_scene(*command, *arguments);
  command->callback([=, &chosen] { chosen = [=] { return check(*arguments); }; });
}
}  // namespace tape::tapesim
