#include <gtest/gtest.h>

#include "cosim/exchange/exchange.hpp"
#include "cosim/roll/settled_roll.hpp"
#include "cosim/run/event_watch.hpp"
#include "cosim/run/read_run.hpp"
#include "tape/contact/intersection.hpp"
#include "tape/core/error.hpp"

namespace {
/// A scene with robots that breaks solvers: what every step must keep is that of the hard cases without robots.
struct RobotCase {
  const char* name;
  const char* text;
  int steps;
  double way;  ///< [m] of a link in a step: farther the worlds are never apart
};

cosim::RunInput read(const std::string& text) {
  cosim::RunInput input =
      cosim::read_run(cosim::SceneFile::parse("film: vinyl_19mm\n" + text, TAPE_SOURCE_DIR "/data/scenes/robot_case.yaml"));
  for (const tape::Strip& strip : input.setup.scene.strips)
    if (strip.winding) cosim::place_roll(cosim::settle_roll(cosim::roll_alone(input.setup, 0), {}), 0, input.setup);
  return input;
}

/// @return the hash of the state at the end
std::string run(const RobotCase& hard, const cosim::RunInput& input) {
  const tape::World world = tape::World::build(input.setup);
  const std::unique_ptr<tape::Stepper> stepper = cosim::make_stepper(tape::Backend::cpu, world, input.robots);
  tape::State state = tape::State::start(world);
  for (int k = 1; k <= hard.steps; ++k) {
    const tape::StepReport report = stepper->step(state);
    const auto* coupled = dynamic_cast<const cosim::CoupledStepper*>(stepper.get());
    note_events(input.events, world, report, coupled->joints(), state);
    if (!report.ok) {
      ADD_FAILURE() << "step " << k << ": " << report.failure;
      break;
    }
    EXPECT_GT(report.min_gap, 0) << k;
    EXPECT_EQ(tape::find_intersections(world.surface, vertex_positions(world, state)).count, 0) << k;
    EXPECT_LT(coupled->exchange().mismatch, hard.way) << k << ": the worlds part";
    if (testing::Test::HasFailure()) break;
  }
  return state.hash();
}

const char* const kFloor = "bodies: {floor: {shape: box, size: [0.2, 0.2, 0.02], position: [0, 0, -0.01], material: floor}}\n";
const std::string kStrip = "strip: {length: 0.08, cells_across: 3, position: [-0.04, 0, 0.0003]}\ncontact: {kappa: 1.0e+5}\n";
const std::string kPresser = "robots: {presser: {urdf: presser.urdf, position: [0, 0, 0.005], drives: {kp: 20000, kd: 200}}}\n";
}  // namespace

class RobotsHard : public testing::TestWithParam<RobotCase> {};
TEST_P(RobotsHard, KeepWhatEveryStepMustKeep) {
  const cosim::RunInput input = read(GetParam().text);
  const std::string first = run(GetParam(), input);
  if (HasFailure()) return;
  EXPECT_EQ(run(GetParam(), input), first) << "run again";
}

const std::string kTargetInside = kStrip + kFloor + kPresser + "script: [{robot: presser, joints: {press: 0.03}}]\n";
const std::string kDeadStop = kStrip + kFloor + kPresser +
                              "script:\n  - {robot: presser, joints: {press: 0.1}, until: {height: \"presser:block\", below: 0.003}}\n"
                              "  - {robot: presser, joints: {press: 0}}\n";
const std::string kFallsOnRoll = std::string(R"(strip: {cells_across: 3, cell_length: 0.003}
model: coh-f
time: {dt: 0.005}
roll: {turns: 1.5, free_length: 0.01, position: [0, 0, 0.0217]}
interfaces:
  - {between: [tape.sticky, tape], law: per_pair, cn: 0.25, ct: 0.25, beta0: 1, slip: bonding}
  - {between: [tape.sticky, hub], law: per_pair, cn: 1, ct: 1, beta0: 1, slip: bonding}
robots: {weight: {urdf: weight.urdf, base: free, position: [0.005, 0.002, 0.06], rotation_deg: [20, 30, 0], velocity: [0, 0, -1]}}
)") + kFloor;

/// A block that wants to be 40 mm inside a closed carton bears down on its flaps and the tape over them with the 50 N that it has.
const char* const kPressOnTheCarton =
    R"(strip: {film: packaging_48mm, length: 0.064, cells_across: 3, position: [0, -0.032, 0.215], rotation_deg: [0, 0, 90]}
contact: {kappa: 1.0e+5}
robots:
  carton:
    urdf: carton.urdf
    joints: {hinge_back: 1.5658, hinge_front: 1.5658, hinge_right: 1.5608, hinge_left: 1.5608}
    drives: {kp: 0.01401, target: 0}
    material: board
  presser: {urdf: presser.urdf, position: [0, 0, 0.3], joints: {press: 0.0845}, drives: {kp: 2000, kd: 50}}
interfaces: [{between: [tape.sticky, board], law: per_pair, cn: 0.25, ct: 0.25, slip: bonding}]
script: [{robot: presser, joints: {press: 0.13}, duration: 0.5}]
)";

/// A dispenser with a roll on its axle falls on a floor that is not level; the film has not been threaded and lies free.
const std::string kDispenserDropped = std::string(R"(strip: {film: packaging_48mm, cells_across: 4, cell_length: 0.0027}
model: coh-r
time: {dt: 0.005}
roll:
  turns: 1.5
  free_length: 0.05
  sense: right
  position: [0, 0, 0.125]
  core: {inner_diameter: 0.0762, outer_diameter: 0.0822, height: 0.048}
robots: {dispenser: {urdf: dispenser.urdf, base: free, position: [0, 0, 0.05], velocity: [0, 0, -1], material: steel}}
axles: [{body: hub, to: "dispenser:cutter", torque: 0.02}]
cluster: {gate: radial}
interfaces:
  - {between: [tape.sticky, tape], law: per_pair, cn: 0.25, ct: 0.25, beta0: 1, slip: bonding}
  - {between: [tape.sticky, hub], law: per_pair, cn: 1, ct: 1, beta0: 1, slip: bonding}
bodies: {floor: {shape: box, size: [0.6, 0.4, 0.02], position: [0, 0, -0.02], rotation_deg: [5, 8, 0], material: floor}}
)");

INSTANTIATE_TEST_SUITE_P(Cases, RobotsHard,
                         testing::Values(RobotCase{"target_inside_the_table", kTargetInside.c_str(), 30, 0.002},
                                         RobotCase{"dead_stop", kDeadStop.c_str(), 40, 0.002},
                                         RobotCase{"falls_on_a_roll", kFallsOnRoll.c_str(), 30, 0.005},
                                         RobotCase{"press_on_the_carton", kPressOnTheCarton, 60, 0.002},
                                         RobotCase{"dispenser_dropped", kDispenserDropped.c_str(), 40, 0.005}),
                         [](const auto& hard) { return std::string(hard.param.name); });

TEST(RobotsHardStart, ALinkThatTouchesTheTapeIsRefusedByName) {
  const cosim::RunInput input =
      read(kStrip + "robots: {presser: {urdf: presser.urdf, position: [0, 0, 0.0001], drives: {kp: 20000, kd: 200}}}\n");
  try {
    tape::World::build(input.setup);
    FAIL() << "accepted";
  } catch (const tape::InputError& e) {
    EXPECT_NE(std::string(e.what()).find("presser:block"), std::string::npos) << e.what();
  }
}
