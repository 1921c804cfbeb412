#include <algorithm>

#include "cosim/roll/settled_roll.hpp"
#include "cosim/run/read_run.hpp"
#include "tape/step/reduce.hpp"
#include "tests/hard/hard_case.hpp"

namespace tape::test {
namespace {
/// A settled roll of two turns of coarse tape, with what else the scene holds and the settings that this changes.
Setup roll(const std::string& scene, const std::vector<std::string>& settings) {
  const std::string text = R"(film: vinyl_19mm
time: {dt: 0.01, duration: 10}
strip: {cells_across: 3, cell_length: 0.003}
roll: {turns: 2, free_length: 0.03, sense: right}
interfaces:
  - {between: [tape.sticky, tape], law: per_pair, cn: 0.25, ct: 0.25, beta0: 1, slip: bonding}
  - {between: [tape.sticky, hub], law: per_pair, cn: 1, ct: 1, beta0: 1, slip: bonding, break_force: 2}
solver: {velocity_tol: 1.0e-3}
)" + scene;
  Setup setup = cosim::read_run(cosim::SceneFile::parse(text, TAPE_SOURCE_DIR "/data/scenes/reduced_case.yaml", settings)).setup;
  cosim::place_roll(cosim::settle_roll(cosim::roll_alone(setup, 0), {}), 0, setup);
  return setup;
}
/// The tip is held and the hub drawn away; it may turn.
Setup payout(const std::string& moves, std::vector<std::string> settings) {
  settings.emplace_back("gravity=[0,0,0]");
  return roll("script:\n  - {grip: tape.tip, as: hand}\n  - {grip: {body: hub, point: [0, 0, 0]}, as: carrier}\n" + moves, settings);
}
std::string away(Real way, Real speed) { return "  - {move: carrier, by: [" + to_text(-way) + ", 0, 0], speed: " + to_text(speed) + "}\n"; }
/// From rest at 10 m/s^2, in pieces of 10 ms.
std::string jerked() {
  std::string moves = away(0.005, 0.025);
  for (int k = 0; k < 12; ++k) moves += away(1e-3 * (k + 0.5), 0.1 * (k + 0.5));
  return moves;
}

long members(const State& state, const World& world) {
  const std::vector<TapePart> parts = tape_parts(world, state);
  return std::count(parts.begin(), parts.end(), TapePart::cluster);
}
/// The front has passed: there are fewer members than at the start, if any are left.
void has_advanced(const Simulation& s, std::vector<std::string>& broken) {
  if (members(s.state(), s.world()) >= members(State::start(s.world()), s.world())) broken.push_back("the front never moved");
}
void has_no_cluster(const Simulation& s, std::vector<std::string>& broken) {
  if (members(State::start(s.world()), s.world()) > 0) broken.push_back("a cluster with a collar that is longer than the tape");
}
}  // namespace

std::vector<HardCase> reduced_cases() {
  const auto of = [](const auto& make, const std::string& text, const std::vector<std::string>& settings) {
    return once([=] { return make(text, settings); });
  };
  const std::string floor = "bodies: {floor: {shape: box, size: [0.3, 0.2, 0.02], position: [0, 0, -0.04]}}\n";
  const std::string wall =
      "bodies: {wall: {shape: box, size: [0.02, 0.1, 0.1], position: [0.0345, 0, 0]}}\naxles: [{body: hub, torque: 0.02, speed: 314.16}]\n";
  return {
      {"reduced_noise_at_the_gate", "a gate as narrow as what the solver leaves", 0.6, true,
       of(payout, away(0.015, 0.025), {"model=coh-r", "cluster.gate_distance=1e-3"})},
      {"reduced_rows_at_once", "tape drawn off at 2 m/s: rows pass in every step", 0.05, true,
       of(payout, away(0.1, 2), {"model=coh-r", "cluster.collar=4"}), has_advanced},
      {"reduced_bonds_at_once", "the same with bonds", 0.05, true, of(payout, away(0.1, 2), {"model=bond-r", "cluster.collar=4"}),
       has_advanced, 1e-6, true},
      {"reduced_turned_back", "the hub goes back over the tape that it has paid out", 0.5, true,
       of(payout, away(0.03, 0.1) + "  - {move: carrier, by: [0.05, 0, 0], speed: 0.5}\n", {"model=coh-r", "cluster.collar=4"}),
       has_advanced},
      {"reduced_collar_of_all", "a collar longer than the tape", 0.3, true,
       of(payout, away(0.01, 0.05), {"model=coh-r", "cluster.collar=200"}), has_no_cluster},
      {"reduced_last_turn", "a cluster that pays out until it is gone", 0.8, true,
       of(payout, away(0.3, 0.25), {"model=coh-r", "roll.turns=1.2", "cluster.collar=3"}), has_advanced, 1e-6, true},
      {"reduced_jerked", "the hub jerked away at 10 m/s^2", 0.35, true, of(payout, jerked(), {"model=coh-r", "cluster.collar=4"}),
       has_advanced},
      {"reduced_on_its_rim", "a roll that lands on its rim at 3 m/s", 0.1, false, once([=] {
         Setup setup = roll(floor, {"model=coh-r", "roll.rotation_deg=[55,0,20]", "roll.position=[0,0,0.005]", "time.dt=0.002"});
         setup.scene.strips[0].velocity = setup.scene.bodies[0].velocity = Vec3(0, 0, -3);
         return setup;
       })},
      {"reduced_spun_up", "a drive takes a roll to 50 turns a second beside a wall that its tail whips", 0.06, true,
       of(roll, wall, {"model=coh-r", "time.dt=0.001", "cluster.gate=radial", "roll.free_length=0.01"})},
  };
}
}  // namespace tape::test
