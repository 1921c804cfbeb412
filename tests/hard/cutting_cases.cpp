#include "cosim/roll/settled_roll.hpp"
#include "cosim/run/attachment.hpp"
#include "cosim/run/read_run.hpp"
#include "tests/hard/hard_case.hpp"

namespace tape::test {
namespace {
Setup scene(const std::string& text, Real threshold) {
  const std::string head =
      "film: vinyl_19mm\ncutting: {blades: [blade], threshold: " + to_text(threshold) + "}\nsolver: {velocity_tol: 1.0e-3}\n";
  Setup setup = cosim::read_run(cosim::SceneFile::parse(head + text, TAPE_SOURCE_DIR "/data/scenes/cutting_case.yaml", {})).setup;
  if (setup.scene.strips[0].winding) cosim::place_roll(cosim::settle_roll(cosim::roll_alone(setup, 0), {}), 0, setup);
  return setup;
}
/// A blade across, its edge at (x, 0, z), which comes down to `to` [m] within `seconds` and stays; `along` [m] it goes from there on in 0.2
/// s.
std::string blade(Real x, Real z, Real to, Real seconds, Real along = 0) {
  const auto place = [](Real a, Real edge) { return "[" + to_text(a) + ", 0, " + to_text(edge + 0.02) + "]"; };
  return "  blade: {shape: mesh, file: knife_blade.obj, motion: driven, rotation_deg: [180, 0, 0], position: " + place(x, z) +
         ", waypoints: [{time: " + to_text(seconds) + ", position: " + place(x, to) + "}, {time: " + to_text(seconds + 0.2) +
         ", position: " + place(x + along, to) + "}]}\n";
}
std::string held_strip(const std::string& moves) {
  return "time: {dt: 0.01, duration: 1}\nstrip: {length: 0.08, cells_across: 4, position: [-0.04, 0, 0]}\n"
         "script:\n  - {grip: tape.root, as: left}\n  - {grip: tape.tip, as: right}\n" +
         moves + "bodies:\n" + blade(0.003, 0.004, -0.02, 0.5);
}
/// On a table that it sticks to, face down.
std::string stuck_strip(const std::string& script, const std::string& blade_body) {
  return "time: {dt: 0.01, duration: 1}\ncontact: {kappa: 2.5e+3}\nstrip: {length: 0.06, cells_across: 4, position: [-0.03, 0, 0.0002]}\n"
         "interfaces: [{between: [tape.sticky, table], law: per_pair, cn: 0.25, ct: 0.25, beta0: 1, slip: bonding}]\n" +
         script + "bodies:\n  table: {shape: box, size: [0.1, 0.04, 0.01], cells: [20, 8, 1], position: [0, 0, -0.005]}\n" + blade_body;
}
std::string roll_under_blade() {
  return "model: coh-r\ntime: {dt: 0.01, duration: 1}\ngravity: [0, 0, 0]\nstrip: {cells_across: 3, cell_length: 0.003}\n"
         "roll: {turns: 2, free_length: 0.06, sense: right}\n"
         "interfaces:\n  - {between: [tape.sticky, tape], law: per_pair, cn: 0.25, ct: 0.25, beta0: 1, slip: bonding}\n"
         "  - {between: [tape.sticky, hub], law: per_pair, cn: 1, ct: 1, beta0: 1, slip: bonding}\n"
         "script:\n  - {grip: tape.tip, as: hand}\n  - {grip: {body: hub, point: [0, 0, 0]}, as: carrier}\n"
         "  - {move: carrier, by: [-0.01, 0, 0], speed: 0.05}\nbodies:\n" +
         blade(0.012, 0.026, 0.01, 0.5);
}

void is_cut(const Simulation& s, std::vector<std::string>& broken) {
  if (cosim::pieces(s.world(), 0) < 2) broken.push_back("the strip is whole");
}
}  // namespace

std::vector<HardCase> cutting_cases() {
  const auto of = [](const std::string& text, Real threshold = 1000) { return once([=] { return scene(text, threshold); }); };
  return {
      {"cut_under_tension", "a strip at two percent of strain snaps back when it is cut", 0.8, true,
       of(held_strip("  - {move: right, by: [0.0016, 0, 0], duration: 0.1}\n")), is_cut},
      {"cut_under_compression", "a strip that has buckled under the blade", 0.8, true,
       of(held_strip("  - {move: right, by: [-0.006, 0, 0], duration: 0.1}\n")), is_cut},
      {"cut_at_the_collar", "a cut where the tape leaves its roll while that turns", 0.8, true, of(roll_under_blade(), 100), is_cut},
      {"cut_while_peeling", "stuck tape is cut between the front of a peel and its end", 0.8, true,
       of(stuck_strip("script: [{grip: tape.tip, as: hand}, {move: hand, by: [-0.01, 0, 0.03], duration: 0.6}]\n",
                      blade(-0.01, 0.002, 0.00045, 0.4))),
       is_cut},
      {"blade_dragged_along", "a blade that goes on along the strip when it has cut it", 0.8, true,
       of(stuck_strip("", blade(-0.015, 0.002, 0.00022, 0.3, 0.03))), is_cut},
  };
}
}  // namespace tape::test
