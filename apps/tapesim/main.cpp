#include <fmt/core.h>

#include <cerrno>
#include <csignal>
#include <cstring>
#include <new>
#include <set>

#include "apps/tapesim/commands.hpp"
#include "cosim/scene/node.hpp"
#include "robot/model/robot_model.hpp"
#include "tape/core/error.hpp"

namespace tape::tapesim {
void add_scene(CLI::App& command, SceneArguments& arguments) {
  command.add_option("SCENE", arguments.scene, "scene file (YAML)")->required();
  command.add_option("--set", arguments.overrides, "set a key of the scene: path.to.key=value; may be repeated")->allow_extra_args(false);
  command.add_option("--model", arguments.model,
                     "how the interfaces inside a roll adhere: coh-f (cohesion) or bond-f (bonds), all of the tape a shell; coh-r or "
                     "bond-r: the wound part one rigid cluster");
}

namespace {
/// The parser alone would only say that a command is missing.
void require_command(const CLI::App& app, const std::string& word) {
  std::set<std::string, std::less<>> names;
  for (const CLI::App* command : app.get_subcommands([](const CLI::App*) { return true; })) names.insert(command->get_name());
  if (word.starts_with('-') || names.contains(word)) return;
  throw InputError(word + ": no such command; " + cosim::suggestion(word, names));
}

/// A variable of the shell that is not set must not read as an option that was not given.
void refuse_empty_values(const CLI::App& app) {
  for (const CLI::App* command : app.get_subcommands())
    for (const CLI::Option* option : command->get_options())
      for (const std::string& value : option->results())
        if (value.empty()) throw InputError(option->get_name() + ": the value is empty");
}

int act(const Action& chosen) {
  const auto say = [](const char* what, const std::exception& e) { fmt::print(stderr, "tapesim: {}{}\n", what, e.what()); };
  try {
    const int code = chosen();
    if (std::fflush(stdout) != 0) throw InputError(std::string("cannot write to standard output: ") + std::strerror(errno));
    return code;
  } catch (const InputError& e) {
    say("", e);
    return kBadInput;
  } catch (const robot::InputError& e) {
    say("", e);
    return kBadInput;
  } catch (const NumericalError& e) {
    say("", e);
    return kFailed;
  } catch (const Interrupted& e) {
    say("", e);
    return kInterrupted;
  } catch (const std::bad_alloc& e) {
    say("out of memory: ", e);
    return kFailed;
  } catch (const std::exception& e) {
    say("internal error, please report it: ", e);
    return kFailed;
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
  app.set_version_flag("--version", "tapesim " TAPE_VERSION);
  app.failure_message(
      [](const CLI::App*, const CLI::Error& e) { return fmt::format("tapesim: {}\nRun with --help for more information.\n", e.what()); });
  Action chosen;
  for (const auto add : {add_run, add_explain, add_wind, add_check, add_study, add_replay, add_render, add_info}) add(app, chosen);
  return act([&] {
    if (argc > 1) require_command(app, argv[1]);
    try {
      app.parse(argc, argv);
    } catch (const CLI::ParseError& e) {
      return app.exit(e) == 0 ? kDone : kBadInput;
    }
    refuse_empty_values(app);
    return chosen();
  });
}
