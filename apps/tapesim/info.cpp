#include <fmt/format.h>

#include <memory>
#include <thread>

#include "apps/report/table.hpp"
#include "apps/tapesim/commands.hpp"
#include "apps/tapesim/settings_list.hpp"
#include "cosim/run/figures.hpp"
#include "tape/step/stepper.hpp"

namespace tape::tapesim {
namespace {
int info(bool settings, bool figures) {
  if (settings) fmt::print("{}", settings_text());
  if (figures) {
    report::Table table{{"figure", "meaning"}, {}};
    for (const cosim::Figure& figure : cosim::all_figures()) table.rows.push_back({std::string(figure.name), std::string(figure.meaning)});
    fmt::print("{}", report::to_text(table));
  }
  if (settings || figures) return kDone;
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
  auto settings = std::make_shared<bool>(false), figures = std::make_shared<bool>(false);
  CLI::App* command = app.add_subcommand("info", "version, back ends found, threads, build flags");
  command->add_flag("--settings", *settings, "every setting of a scene: default, unit, range, meaning");
  command->add_flag("--figures", *figures, "every figure that a scene may ask for");
  command->callback([=, &chosen] { chosen = [=] { return info(*settings, *figures); }; });
}
}  // namespace tape::tapesim
