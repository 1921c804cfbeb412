#include <fmt/core.h>

#include <csignal>
#include <new>

#include "apps/tapesim/commands.hpp"
#include "tape/core/error.hpp"

namespace tape::tapesim {
void add_scene(CLI::App& command, SceneArguments& arguments) {
  command.add_option("SCENE", arguments.scene, "scene file (YAML)")->required();
  command.add_option("--set", arguments.overrides, "set a key of the scene: path.to.key=value; may be repeated")->allow_extra_args(false);
}

namespace {
int act(const Action& chosen) {
  const auto say = [](const char* what, const std::exception& e) { fmt::print(stderr, "tapesim: {}{}\n", what, e.what()); };
  try {
    return chosen();
  } catch (const InputError& e) {
    say("", e);
    return kBadInput;
  } catch (const std::bad_alloc& e) {
    say("out of memory: ", e);
    return kBadInput;
  } catch (const std::exception& e) {
    say("internal error, please report it: ", e);
    return kNumericalFailure;
  }
}
}  // namespace
}  // namespace tape::tapesim

int main(int argc, char** argv) {
  using namespace tape::tapesim;
  std::signal(SIGXFSZ, SIG_IGN);  // a file that may not grow, or a reader that has gone, is an error like any other
  std::signal(SIGPIPE, SIG_IGN);
  CLI::App app{"tape: simulates adhesive tape", "tapesim"};
  app.require_subcommand(1);
  Action chosen;
  for (const auto add : {add_run, add_explain, add_check, add_study, add_render, add_info}) add(app, chosen);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& e) {
    return app.exit(e) == 0 ? kDone : kBadInput;
  }
  return act(chosen);
}
