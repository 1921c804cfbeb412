#include <fmt/format.h>

#include <filesystem>
#include <map>
#include <memory>

#include "apps/report/table.hpp"
#include "apps/tapesim/scene_input.hpp"
#include "cosim/roll/roll_figures.hpp"
#include "cosim/roll/settled_roll.hpp"
#include "cosim/run/new_file.hpp"

namespace tape::tapesim {
namespace {
struct WindArguments {
  std::string film, core, sense = "left", out;
  double turns = 0;
  std::vector<std::string> overrides;
};

/// As YAML takes it whatever it holds.
std::string quoted(const std::string& text) {
  std::string out = "'";
  for (char c : text) out += c == '\'' ? std::string("''") : std::string(1, c);
  return out + "'";
}

/// The scene of a roll and nothing else; --set changes it as that of any scene.
std::string scene_text(const WindArguments& a) {
  std::string text =
      fmt::format("film: {}\nroll: {{turns: {}, sense: {}}}\n", quoted(std::filesystem::absolute(a.film).string()), a.turns, a.sense);
  text += "interfaces:\n";
  for (const char* to : {"tape", "hub"}) text += fmt::format("  - {{between: [tape.sticky, {}], law: per_pair, beta0: 1}}\n", to);
  return text;
}

cosim::RunInput read(const WindArguments& a) {
  std::vector<std::string> overrides;
  if (!a.core.empty()) {
    const cosim::SceneFile core = cosim::SceneFile::load(a.core);
    Core settings;
    core.root().read(settings);
    core.require_all_used();
    settings.fields([&](const char* name, auto& value, const char*, Range, const char*) {
      overrides.push_back(fmt::format("roll.core.{}={}", name, value));
    });
  }
  overrides.insert(overrides.end(), a.overrides.begin(), a.overrides.end());
  cosim::RunInput input = cosim::read_run(cosim::SceneFile::parse(scene_text(a), "roll", overrides));
  input.file.require_all_used();
  return input;
}

int wind(const WindArguments& arguments) {
  cosim::RunInput input = read(arguments);
  if (!cosim::holds_together(input.setup, 0)) throw InputError("the tape of this roll does not adhere to itself: it would spring open");
  cosim::require_writable(arguments.out);  // before the work
  const cosim::SettledRoll roll = cosim::settle_roll(cosim::roll_alone(input.setup, 0), watched_settle());
  cosim::save_roll(arguments.out, roll);
  fmt::print("{}: at rest after {} steps, {:.2g} m/s\n", arguments.out, roll.report.steps, roll.report.speed);
  const Scene& scene = roll.world.setup.scene;
  const Winding& winding = *scene.strips[0].winding;
  const AxialMass tape = annulus_mass(winding, scene.films[0]);
  const Body& hub = scene.bodies[0];
  const Real hub_inertia = hub.solid->second(0, 0) + hub.solid->second(1, 1);  // per density, about its axis z
  const std::map<std::string, Real> formula = {{"turns", winding.turns},
                                               {"wound_length_m", annulus_length(winding)},
                                               {"outer_radius_m", annulus_radius(winding)},
                                               {"roll_mass_kg", tape.mass + hub.density * hub.solid->volume},
                                               {"roll_inertia_kg_m2", tape.inertia + hub.density * hub_inertia}};
  for (const auto& [name, value] : cosim::roll_figures(roll.world, roll.state, 0)) {
    const auto expected = formula.find(name);
    fmt::print("  {} = {}{}\n", name, report::rounded(value),
               expected == formula.end() ? "" : fmt::format(" (as wound: {})", report::rounded(expected->second)));
  }
  return kDone;
}
}  // namespace

void add_wind(CLI::App& app, Action& chosen) {
  auto arguments = std::make_shared<WindArguments>();
  CLI::App* command = app.add_subcommand("wind", "winds a roll, lets it come to rest and saves it as an asset for `roll.asset` of a scene");
  command->add_option("FILM", arguments->film, "film (YAML), as data/tapes/vinyl_19mm.yaml")->required();
  command->add_option("--turns", arguments->turns, "turns of tape around the core")->required();
  command->add_option("--core", arguments->core, "core (YAML), with the keys of roll.core; default: that of 19-mm vinyl tape");
  command->add_option("--sense", arguments->sense, "side to which the free end leaves the top; an asset serves both, turned by half a turn")
      ->check(CLI::IsMember({"left", "right"}));
  command->add_option("--out", arguments->out, "file of the asset")->required();
  command->add_option("--set", arguments->overrides, "set a key of the roll's scene, as roll.free_length=0.15 or interfaces.0.law=bond")
      ->allow_extra_args(false);
  command->callback([=, &chosen] { chosen = [=] { return wind(*arguments); }; });
}
}  // namespace tape::tapesim
