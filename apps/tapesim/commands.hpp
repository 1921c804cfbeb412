#pragma once
#include <CLI/CLI.hpp>
#include <functional>
#include <string>
#include <vector>

/// The subcommands of tapesim, one file each. `add_...` declares its options; what it is to do is left in `chosen`, which returns the exit
/// code and is called once the whole command line is known to be right.
namespace tape::tapesim {
constexpr int kDone = 0, kFailed = 1, kBadInput = 2, kInterrupted = 130;

using Action = std::function<int()>;
void add_run(CLI::App& app, Action& chosen);
void add_explain(CLI::App& app, Action& chosen);
void add_wind(CLI::App& app, Action& chosen);
void add_check(CLI::App& app, Action& chosen);
void add_study(CLI::App& app, Action& chosen);
void add_replay(CLI::App& app, Action& chosen);
void add_render(CLI::App& app, Action& chosen);
void add_info(CLI::App& app, Action& chosen);

/// SCENE, --set and --model, which several subcommands share.
struct SceneArguments {
  std::string scene;
  std::vector<std::string> overrides;
  std::string model;
};
void add_scene(CLI::App& command, SceneArguments& arguments);
}  // namespace tape::tapesim
