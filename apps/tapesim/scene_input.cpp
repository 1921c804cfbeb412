#include "apps/tapesim/scene_input.hpp"

#include <fmt/format.h>

#include <memory>

#include "apps/movie/things.hpp"
#include "apps/tapesim/interrupt.hpp"
#include "apps/tapesim/progress.hpp"
#include "cosim/roll/roll_store.hpp"
#include "cosim/run/figures.hpp"

namespace tape::tapesim {
namespace {
/// What the solver refuses it names by strips and bodies; the file is ours to add.
World build_world(const cosim::RunInput& run, const std::string& file) {
  try {
    return World::build(run.setup);
  } catch (const InputError& e) {
    std::string why = file + ": " + e.what();
    for (std::size_t s = 0; s < run.setup.scene.strips.size(); ++s)
      if (as_wound(run, s))
        why += " (roll '" + run.setup.scene.strips[s].name + "' stands as it is wound: a run lets it come to rest first)";
    throw InputError(why);
  }
}

/// What bears a force that pictures may show.
std::vector<std::string> bearers(const cosim::RunInput& run) {
  std::vector<std::string> names;
  for (const Grip& grip : run.setup.scene.grips) names.push_back(grip.name);
  for (const cosim::RobotPart& robot : run.robots.robots)
    for (int link = 0; link < static_cast<int>(robot.model->links.size()); ++link) names.push_back(body_name(robot, link));
  return names;
}

void settle(cosim::RunInput& run, const std::string& file, Rolls rolls) {
  if (!run.settle_roll) return;
  try {
    cosim::settle_rolls(run.setup, {.asset = run.roll_asset, .wind = rolls == Rolls::settle, .settle = watched_settle()});
  } catch (const InputError& e) {
    throw InputError(file + ": " + e.what());
  }
}
}  // namespace

bool as_wound(const cosim::RunInput& run, std::size_t strip) {
  return run.settle_roll && run.setup.scene.strips[strip].settled.empty() && cosim::holds_together(run.setup, strip);
}

SettleParams watched_settle() {
  SettleParams params;
  params.go_on = [progress = std::shared_ptr<Progress>(), last = params.max_steps](int steps, Real speed) mutable {
    if (!progress) {
      remember_interrupts();
      progress = std::make_shared<Progress>("wind", last);
    }
    progress->update(steps, fmt::format("{:.2g} m/s", speed));
    return !interrupted();
  };
  return params;
}

SceneInput load_scene(const SceneArguments& arguments) {
  std::vector<std::string> overrides = arguments.overrides;
  if (!arguments.model.empty()) overrides.push_back("model=" + arguments.model);
  SceneInput input{cosim::read_run(cosim::SceneFile::load(arguments.scene, overrides)), {}, {}};
  input.pictures = movie::read_pictures(input.run.file.root(), bearers(input.run));
  input.run.file.read("record", input.episode);
  input.run.file.require_all_used();
  return input;
}

LoadedWorld load_world(const SceneArguments& arguments, Rolls rolls, const std::function<void(cosim::RunInput&)>& prepare) {
  SceneInput input = load_scene(arguments);
  if (prepare) prepare(input.run);
  settle(input.run, arguments.scene, rolls);
  World world = build_world(input.run, arguments.scene);
  try {
    cosim::require_figures(input.run.figures, world);
  } catch (const InputError& e) {
    input.run.file["record"]["figures"].fail(e.what());
  }
  try {
    movie::require_things(input.pictures.cameras, cosim::RecordedMesh::of(world, input.run.robots, input.run.phases, "", ""));
  } catch (const InputError& e) {
    input.run.file["camera"].fail(e.what());
  }
  return {std::move(input), std::move(world)};
}
}  // namespace tape::tapesim
