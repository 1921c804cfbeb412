#include <fmt/format.h>

#include <memory>

#include "apps/tapesim/scene_input.hpp"
#include "tape/step/roll_gaps.hpp"

namespace tape::tapesim {
namespace {
std::string gaps_text(const GapsBelow& gaps) {
  return fmt::format("up to {:.4g} m ({} of {} vertices have nothing within dhat to stick to{})", gaps.largest, gaps.apart, gaps.vertices,
                     gaps.apart == gaps.vertices ? ": lower roll.pitch" : "");
}

void print_rolls(const LoadedWorld& loaded) {
  const World& world = loaded.world;
  const Scene& scene = world.setup.scene;
  for (std::size_t s = 0; s < scene.strips.size(); ++s) {
    if (!scene.strips[s].winding) continue;
    const RollGaps gaps = roll_gaps(scene, world.assembly, world.surface, world.assembly.x, static_cast<int>(s));
    fmt::print("roll '{}': pitch {} m, gaps from {:.4g} m; to the hub {}", scene.strips[s].name, to_text(scene.strips[s].winding->pitch),
               gaps.smallest, gaps_text(gaps.hub));
    if (gaps.layers.vertices > 0) fmt::print("; between layers {}", gaps_text(gaps.layers));
    fmt::print("{}\n", as_wound(loaded.input.run, s) ? "; as it is wound: a run lets it come to rest first" : "");
  }
}

int check(const SceneArguments& arguments) {
  const LoadedWorld loaded = load_world(arguments, Rolls::as_known);
  const Scene& scene = loaded.world.setup.scene;
  fmt::print("{}: sound. Strips: {}, bodies: {}, vertices: {}, triangles: {}, unknowns: {}; {} steps of {} s\n", arguments.scene,
             scene.strips.size(), scene.bodies.size(), loaded.world.assembly.surface_vertices, loaded.world.assembly.triangles.size(),
             3 * loaded.world.assembly.blocks, cosim::planned_steps(scene), to_text(scene.time.dt));
  print_rolls(loaded);
  for (const std::string& note : cosim::notes_on(loaded.input.run.robots)) fmt::print("robot {}\n", note);
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
