#include <fmt/format.h>

#include <memory>
#include <optional>
#include <thread>

#include "apps/report/table.hpp"
#include "apps/tapesim/commands.hpp"
#include "apps/tapesim/settings_list.hpp"
#include "cosim/run/figures.hpp"
#include "robot/urdf/describe.hpp"
#include "robot/urdf/read_urdf.hpp"
#include "tape/step/stepper.hpp"

namespace tape::tapesim {
namespace {
/// What `tapesim info` is asked for.
struct Question {
  bool settings = false, figures = false;
  std::optional<std::string> robot;
  robot::UrdfOptions urdf;
};

int info(const Question& about) {
  if (about.settings) fmt::print("{}", settings_text());
  if (about.figures) {
    report::Table table{{"figure", "meaning"}, {}};
    for (const cosim::Figure& figure : cosim::all_figures()) table.rows.push_back({std::string(figure.name), std::string(figure.meaning)});
    fmt::print("{}", report::to_text(table));
  }
  if (about.robot) fmt::print("{}", robot::describe(robot::read_urdf(*about.robot, about.urdf)));
  if (about.settings || about.figures || about.robot) return kDone;
#ifdef TAPE_HAS_CUDA
  const char* cuda = cuda_available() ? "cuda: a device answers" : "cuda: built in, but no device answers";
#else
  const char* cuda = "cuda: not in this build";
#endif
  fmt::print("tapesim {}\nback ends: cpu; {}\nthreads: {}\nbuild: {}\n", TAPE_VERSION, cuda, std::thread::hardware_concurrency(),
             TAPE_BUILD);
  return kDone;
}
}  // namespace

void add_info(CLI::App& app, Action& chosen) {
  auto about = std::make_shared<Question>();
  CLI::App* command = app.add_subcommand("info", "version, back ends found, threads, build flags; what was understood of a robot");
  command->add_flag("--settings", about->settings, "every setting of a scene: default, unit, range, meaning");
  command->add_flag("--figures", about->figures, "every figure that a scene may ask for");
  CLI::Option* robot =
      command->add_option("--robot", about->robot, "a robot (URDF): its tree, limits, masses, reach, and what was assumed");
  command->add_option("--package-root", about->urdf.package_root, "folder of the packages that the robot's meshes are in")->needs(robot);
  command->add_option("--srdf", about->urdf.srdf, "which of its links may overlap; else the file beside it, X.srdf")->needs(robot);
  command->callback([=, &chosen] { chosen = [=] { return info(*about); }; });
}
}  // namespace tape::tapesim
