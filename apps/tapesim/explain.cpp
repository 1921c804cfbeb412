#include <fmt/format.h>

#include <algorithm>
#include <memory>

#include "apps/tapesim/recorded_run.hpp"
#include "apps/tapesim/scene_input.hpp"

namespace tape::tapesim {
namespace {
struct Line {
  std::string name;
  bool on;
  std::string why;
};

/// "file:line" of a key of the scene, or of the section or name that it comes with (film.poisson: film); empty for defaults.
std::string place(const cosim::SceneFile& file, std::string key) {
  for (std::string where;;) {
    const std::string of_roll = key == "strip" || key == "bodies.hub" ? "roll" : key;
    for (const std::string& name : {key, key + "s", of_roll})  // strip, or strips, or what makes them
      if (where = file.where(name); !where.empty()) return where;
    if (key.find('.') == std::string::npos) return "";
    key.resize(key.rfind('.'));
  }
}

/// What asks for an effect, with the line of the scene that does, unless a default does.
std::string reason(const cosim::RunInput& input, const PlanLine& line) {
  const std::string where = place(input.file, line.why);
  if (!where.empty()) return fmt::format("{} ({})", line.why, where);
  return line.on ? line.why + " (default)" : line.why;
}

/// Stages of a step that are not effects, and parts of the testbed that this build leaves out.
std::vector<Line> stages(const World& world, const cosim::RobotScene& robots) {
  std::string remembering;
  for_each_effect([&]<class T>(std::type_identity<T>) {
    if (Remembers<T> && world.is_on(T::name)) remembering += (remembering.empty() ? "" : ", ") + std::string(T::name);
  });
  std::string sleeping = world.is_on(Seat::name) ? "seat" : "";
  if (world.setup.scene.sleep.after > 0) sleeping += (sleeping.empty() ? "" : ", ") + std::string("sleep");
  const bool contact = world.is_on(Barrier::name);
  const std::string why = contact ? "barrier" : "barrier is off";
  return {
      {"broad_phase", contact, why},
      {"narrow_phase", contact, why},
      {"ccd", contact, why},
      {"assembly", true, "every step"},
      {"linear_solver", true, "solver.linear: " + to_text(world.setup.linear.linear)},
      {"line_search", true, "every step"},
      {"history", !remembering.empty(), remembering.empty() ? "no effect that is on remembers" : remembering},
      {"reduction", world.clusters() > 0, world.clusters() > 0 ? "model" : "no model that is reduced"},
      {"cutting", !world.setup.scene.blades.empty(), world.setup.scene.blades.empty() ? "no blades" : "cutting"},
      {"sleeping", !sleeping.empty(), sleeping.empty() ? "no cluster that may rest on its hub; sleep.after is 0" : sleeping},
      {"cosim", !robots.robots.empty(), robots.robots.empty() ? "no robots" : "robots"},
  };
}

int explain(const SceneArguments& arguments, const std::string& backend_name) {
  const LoadedWorld loaded = load_world(arguments, Rolls::as_known);
  if (backend_name == "cuda" && !cuda_available()) throw InputError("--backend cuda: no CUDA device answers, or this build has no CUDA");
  const std::string backend = runs_on_cuda(backend_of(backend_name), loaded.world) ? "cuda" : "cpu";
  std::vector<Line> lines;
  for (const PlanLine& line : loaded.world.plan) lines.push_back({line.name, line.on, reason(loaded.input.run, line)});
  for (Line& line : stages(loaded.world, loaded.input.run.robots)) lines.push_back(std::move(line));
  for (const Line& line : lines) {
    const bool host = line.name == "linear_solver" && loaded.world.setup.linear.linear == LinearKind::cholesky;
    const std::string where = line.on ? fmt::format(" [{}]", host ? "cpu" : backend) : "";
    fmt::print("{:<13} {:<3} {}{}\n", line.name, line.on ? "on" : "off", line.why, where);
  }
  return kDone;
}
}  // namespace

void add_explain(CLI::App& app, Action& chosen) {
  auto arguments = std::make_shared<SceneArguments>();
  auto backend = std::make_shared<std::string>("auto");
  CLI::App* command = app.add_subcommand("explain", "says which effects and stages run, and what asks for them");
  add_scene(*command, *arguments);
  command->add_option("--backend", *backend, "auto, cpu or cuda")->check(CLI::IsMember({"auto", "cpu", "cuda"}));
  command->callback([=, &chosen] { chosen = [=] { return explain(*arguments, *backend); }; });
}
}  // namespace tape::tapesim
