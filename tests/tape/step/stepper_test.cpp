#include "tape/step/stepper.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>

#include "tape/core/execution.hpp"
#include "tape/math/rotation.hpp"
#include "tape/model/primitives.hpp"
#include "tests/support/simulation.hpp"
using namespace tape;
using test::Simulation;

namespace {
/// A strip falling on a fixed drum, with a loose box on its way: contact, friction and a rigid body.
Setup busy_setup() {
  auto setup = test::strip_setup(test::flat_strip(0.06, 3, Vec3(-0.02, 0, 0.0225)));
  Body& drum = test::add_body(setup, "drum", cylinder_mesh(0.02, 0.03, 24, 1), Motion::fixed, Vec3::Zero());
  drum.pose.rotation = rotation_exp(Vec3(std::numbers::pi / 2, 0, 0));
  test::add_body(setup, "box", box_mesh(Vec3(0.01, 0.01, 0.01)), Motion::dynamic, Vec3(0.002, 0, 0.03));
  return setup;
}
/// The same things, large enough that every loop of a step is cut into many chunks: a fine strip that slides on a table, a box on it.
Setup wide_setup() {
  Strip strip = test::flat_strip(0.3, 12, Vec3(-0.15, 0, 2e-4));
  strip.velocity = Vec3(0.1, 0.02, 0);
  auto setup = test::strip_setup(strip);
  test::add_body(setup, "table", box_mesh(Vec3(0.4, 0.06, 0.01)), Motion::fixed, Vec3(0, 0, -0.005));
  test::add_body(setup, "box", box_mesh(Vec3(0.01, 0.01, 0.01)), Motion::dynamic, Vec3(0.002, 0, 0.0054));
  return setup;
}
std::string wide_hash(int threads, std::uint64_t shuffle) {
  const std::uint64_t usual = shuffled_order();
  set_threads(threads), set_shuffled_order(shuffle);
  Simulation simulation(wide_setup());
  for (int k = 0; k < 3; ++k) simulation.step();
  set_threads(0), set_shuffled_order(usual);
  EXPECT_TRUE(simulation.broken.empty()) << simulation.broken.front();
  EXPECT_GT(simulation.state().x.size(), 2000u);
  EXPECT_GT(simulation.report().active_pairs, 1000);
  return simulation.state().hash();
}
}  // namespace

TEST(Stepper, FreeFallIsTheSumOfImplicitEuler) {
  auto setup = test::strip_setup(test::flat_strip(0.05, 3, Vec3::Zero()));
  Simulation simulation(setup);
  const int n = 20;
  for (int k = 0; k < n; ++k) simulation.step();
  EXPECT_TRUE(simulation.broken.empty());
  // v_k = k g dt and x_n = dt sum v_k = g dt^2 n (n + 1) / 2.
  const Real drop = 9.81 * 1e-4 * n * (n + 1) / 2;
  for (const Vec3& p : simulation.state().x) EXPECT_NEAR(p.z(), -drop, 1e-9);
  EXPECT_EQ(simulation.newton_max, 2) << "a quadratic needs one update, and one more to see that it was right";
}

TEST(Stepper, SameBitsForAnyNumberOfThreads) {
  const std::string one = wide_hash(1, 0);
  EXPECT_EQ(one, wide_hash(2, 0));
  EXPECT_EQ(one, wide_hash(8, 0));
}

TEST(Stepper, SameBitsForAnyOrderOfIterations) { EXPECT_EQ(wide_hash(2, 0), wide_hash(1, 7)); }

TEST(Stepper, SaveAndResumeGivesTheSameBits) {
  const std::string file = (std::filesystem::temp_directory_path() / "tape_resume_test.h5").string();
  Simulation whole(busy_setup()), resumed(busy_setup());
  for (int k = 0; k < 8; ++k) whole.step();
  save_snapshot(file, whole.world(), whole.state());
  resumed.state() = load_snapshot(file, resumed.world());
  EXPECT_EQ(resumed.state().hash(), whole.state().hash());
  for (int k = 0; k < 8; ++k) whole.step(), resumed.step();
  EXPECT_EQ(resumed.state().hash(), whole.state().hash());
  std::filesystem::remove(file);
}

TEST(Stepper, ASnapshotThatIsCutShortOrOfAnotherSceneIsRefused) {
  const std::string file = (std::filesystem::temp_directory_path() / "tape_truncated_test.h5").string();
  Simulation simulation(busy_setup());
  save_snapshot(file, simulation.world(), simulation.state());
  const Simulation other(test::strip_setup(test::flat_strip(0.05, 3, Vec3::Zero())));
  EXPECT_THROW(load_snapshot(file, other.world()), InputError);
  std::filesystem::resize_file(file, std::filesystem::file_size(file) / 2);
  EXPECT_THROW(load_snapshot(file, simulation.world()), InputError);
  EXPECT_THROW(load_snapshot(file + ".missing", simulation.world()), InputError);
  std::filesystem::remove(file);
}

TEST(Stepper, ATighterToleranceTakesMoreIterations) {
  for (const StopRule rule : {StopRule::velocity, StopRule::work}) {
    int last = 0;
    for (const Real tolerance : {1e-1, 1e-3, 1e-6}) {
      auto setup = busy_setup();
      setup.newton.stop = rule;
      setup.newton.velocity_tol = tolerance;
      Simulation simulation(setup);
      for (int k = 0; k < 15; ++k) simulation.step();
      EXPECT_GT(simulation.newton_sum, last) << to_text(rule) << " at " << tolerance << " m/s";
      last = simulation.newton_sum;
    }
  }
}

TEST(Stepper, TheTwoLevelSolverKnowsWhereTheStripIsAndNeedsAnEighthOfTheIterationsOfBlockJacobi) {
  const auto iterations = [](LinearKind linear) {
    auto setup = test::strip_setup(test::flat_strip(0.3, 6, Vec3::Zero()));
    setup.scene.grips.push_back(test::hold("wall", {0, 1, 2, 3, 4, 5, 6}));
    setup.linear.linear = linear;
    Simulation simulation(setup);
    int sum = 0;
    for (int k = 0; k < 5; ++k) sum += simulation.step().linear_iterations;
    EXPECT_TRUE(simulation.broken.empty()) << simulation.broken.front();
    return sum;
  };
  EXPECT_LE(8 * iterations(LinearKind::pcg_two_level), iterations(LinearKind::pcg_jacobi));
}

TEST(Stepper, AGripPullsInTheStepsBetweenItsStartAndItsEnd) {
  auto setup = test::strip_setup(test::flat_strip(0.05, 3, Vec3::Zero()));
  Grip grip = test::hold("hand", {0, 1, 2, 3});
  grip.start = 0.02, grip.end = 0.04;  // steps of 0.01 s
  setup.scene.grips = {grip};
  Simulation simulation(setup);
  for (const bool pulls : {false, false, true, true, false}) {
    const Vec3 force = simulation.step().grip_force[0];
    EXPECT_EQ(force.norm() > 0, pulls) << "step " << simulation.state().step;
  }
}

TEST(Stepper, WhatWorksOnContactIsOffWithIt) {
  auto setup = busy_setup();
  setup.forced["barrier"] = false;
  const Simulation simulation(setup);
  for (const PlanLine& line : simulation.world().plan)
    if (line.name == "friction") {
      EXPECT_FALSE(line.on);
      EXPECT_EQ(line.why, "it works on contact, and barrier is off");
    }
  setup.forced["friction"] = true;
  EXPECT_THROW(Simulation{setup}, InputError);
}

TEST(Stepper, ContactThatIsOffHasNoStages) {
  for (const bool on : {true, false}) {
    auto setup = busy_setup();
    setup.forced["barrier"] = on;
    Simulation simulation(setup);
    std::vector<std::string> stages;
    for (const StageReport& stage : simulation.step().stages) stages.push_back(stage.name);
    EXPECT_EQ(std::ranges::count(stages, "broad_phase"), on ? 1 : 0);
    EXPECT_EQ(std::ranges::count(stages, "ccd"), on ? 1 : 0);
    EXPECT_EQ(std::ranges::count(stages, "linear_solver"), 1);
  }
}

TEST(Stepper, AForcedOffEffectIsNotBuilt) {
  auto setup = busy_setup();
  setup.forced["friction"] = false;
  Simulation simulation(setup);
  simulation.step();
  for (const EffectReport& e : simulation.report().effects) EXPECT_NE(e.name, "friction");
  setup.forced["magnetism"] = true;
  EXPECT_THROW(Simulation{setup}, InputError);
}

TEST(Stepper, ATorqueFreeBodyKeepsItsAngularMomentum) {
  tape::Setup setup;
  setup.scene.gravity.setZero();
  setup.scene.time.dt = 0.01;
  test::add_body(setup, "box", box_mesh(Vec3(0.01, 0.02, 0.04)), Motion::dynamic, Vec3::Zero()).angular_velocity =
      Vec3(1e-3, 10, 0);  // about the middle axis: it flips (Dzhanibekov)
  setup.newton.velocity_tol = 1e-9;
  Simulation simulation(setup);
  simulation.step();
  const Vec3 start = simulation.report().angular_momentum;
  Real energy = simulation.report().kinetic, lowest = 1;
  const Real first = energy;
  for (int k = 0; k < 500; ++k) {
    simulation.step();
    lowest = std::fmin(lowest, (simulation.state().bodies[0].pose.rotation * Vec3::UnitY()).dot(start.normalized()));
    EXPECT_LT((simulation.report().angular_momentum - start).norm(), 1e-9 * start.norm());
    EXPECT_LT(simulation.report().kinetic, energy + 1e-9 * first) << "step " << k;
    energy = simulation.report().kinetic;
  }
  EXPECT_LT(lowest, -0.9) << "it did not flip";
}
