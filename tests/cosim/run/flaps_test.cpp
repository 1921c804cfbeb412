// A carton's flaps, tape over their gap, and a scene that judges whether it holds them.
#include <gtest/gtest.h>

#include <algorithm>
#include <numbers>

#include "cosim/exchange/exchange.hpp"
#include "cosim/run/read_run.hpp"
#include "cosim/run/summary.hpp"

namespace {
constexpr double kClosed = std::numbers::pi / 2;         // [rad]
constexpr double kTwenty = 20 * std::numbers::pi / 180;  // [rad]

/// Half a degree from closed, tape over the gap of the outer flaps. A block presses it on, goes up, and holds nothing any more.
/// The law counts by pairs: 1 N on cells of 16 mm is as much as the 0.25 N on 8 mm of the shipped scene.
const std::string kScene = R"(film: packaging_48mm
time: {dt: 0.02, duration: 1.4}
contact: {kappa: 1.0e+5}
strip: {length: 0.064, cells_across: 3, position: [0, -0.032, 0.215], rotation_deg: [0, 0, 90]}
robots:
  carton:
    urdf: carton.urdf
    joints: {hinge_back: 1.5658, hinge_front: 1.5658, hinge_right: 1.5608, hinge_left: 1.5608}
    drives: {kp: 0.01401, target: 0}
    material: board
  presser: {urdf: presser.urdf, position: [0, 0, 0.3], joints: {press: 0.0845}, drives: {kp: 2000, kd: 50, effort: 20}}
interfaces: [{between: [tape.sticky, board], law: per_pair, cn: 1, ct: 1, slip: bonding}]
script:
  - {robot: presser, joints: {press: 0.089}, duration: 0.2}
  - {wait: 0.1}
  - {robot: presser, joints: {press: 0}, duration: 0.9}
conditions:
  - {name: right, joint: "carton:hinge_right", above: 1.4835, held: 0.5}
  - {name: left, joint: "carton:hinge_left", above: 1.4835, held: 0.5}
  - {name: seam, seam: [tape, "carton:flap_left", "carton:flap_right"], along: [0, 1, 0], above: 0.06}
)";
cosim::RunSummary run(const std::vector<std::string>& overrides) {
  const cosim::RunInput input = cosim::read_run(cosim::SceneFile::parse(kScene, TAPE_SOURCE_DIR "/data/scenes/flaps_test.yaml", overrides));
  tape::World world = tape::World::build(input.setup);
  const std::unique_ptr<tape::Stepper> stepper = cosim::make_stepper(tape::Backend::cpu, world, input.robots);
  tape::State state = tape::State::start(world);
  return cosim::summarize(world, cosim::simulate(world, *stepper, state, {.events = input.events, .goals = input.goals}), {});
}
cosim::Condition condition(const cosim::RunSummary& summary, const std::string& name) {
  return *std::ranges::find(summary.conditions, name, &cosim::Condition::name);
}
}  // namespace

TEST(Flaps, AStripPressedOverTheGapHoldsThem) {
  const cosim::RunSummary held = run({});
  EXPECT_EQ(held.status, "done") << held.failure;
  for (const cosim::Condition& c : held.conditions)
    if (c.stated) {
      EXPECT_TRUE(c.met) << c.name << " = " << c.value;
    }
  EXPECT_FALSE(held.fell_short);
  EXPECT_LT(condition(held, "right").value, kClosed + 0.01) << "the stop is at a right angle";
  EXPECT_LE(condition(held, "seam").value, 0.064 + 1e-6) << "the strip is no longer";
  EXPECT_EQ(held.intersections, 0);
}
TEST(Flaps, WithoutAdhesionTheyOpenByTwentyDegreesAndTheRunFails) {
  const cosim::RunSummary loose = run({"effects.cohesion=off"});
  EXPECT_EQ(loose.status, "done") << loose.failure;
  EXPECT_TRUE(loose.fell_short);
  for (const char* flap : {"right", "left"}) {
    EXPECT_FALSE(condition(loose, flap).met);
    EXPECT_LT(condition(loose, flap).value, kClosed - kTwenty) << flap;
  }
  EXPECT_EQ(condition(loose, "seam").value, 0);
}
