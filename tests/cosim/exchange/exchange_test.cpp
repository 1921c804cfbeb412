#include "cosim/exchange/exchange.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "tape/core/execution.hpp"
#include "tape/model/primitives.hpp"
#include "tests/cosim/exchange/robots.hpp"
using namespace cosim::test;
using cosim::RobotScene;
using cosim::Schedule;
using robot::Vec3;
using tape::Real;

namespace {
/// Two cubes of 4 g on a hinge, floating above the middle of a free strip in space, on their way down.
RobotScene two_links(const Vec3& velocity, std::vector<robot::DriveGains> drives = {}) {
  RobotModel model{.name = "pair"};
  model.links = {box_link("first", 0.004, Vec3::Constant(0.01)), box_link("second", 0.004, Vec3::Constant(0.01), Vec3(0.012, 0, 0))};
  model.joints = {joint("hinge", robot::JointType::continuous, Vec3::UnitY(), Vec3(0.006, 0, 0))};
  RobotScene scene;
  scene.world.gravity.setZero();
  scene.robots = {part("pair", model, Vec3(-0.008, 0.002, 0.0055), false)};
  scene.robots[0].params.drives = std::move(drives);
  scene.robots[0].velocity = velocity;
  return scene;
}
tape::Setup free_strip(Real dt, Real tolerance) {
  tape::Setup s = tape::test::strip_setup(tape::test::flat_strip(0.06, 3, Vec3(-0.03, 0, 0)));
  s.scene.gravity.setZero();
  s.scene.time.dt = dt;
  s.newton.velocity_tol = tolerance;
  return s;
}
/// A finger of 7.5e-6 kg m^2 about its hinge, driven by 50 N m/rad and 0.5 N m s/rad over ten substeps to 2.4 mm below the strip.
RobotScene finger(double effort = std::numeric_limits<double>::infinity()) {
  RobotModel model{.name = "finger"};
  model.links = {{.name = "palm"}, box_link("tip", 0.004, Vec3(0.01, 0.01, 0.01), Vec3(0.04, 0, 0))};
  model.links[1].inertial = {0.004, Vec3(0.04, 0, 0), Vec3(6e-8, 7.5e-6 - 0.004 * 0.0016, 7.5e-6 - 0.004 * 0.0016).asDiagonal()};
  model.joints = {joint("hinge", robot::JointType::revolute, Vec3::UnitY(), Vec3::Zero())};
  RobotScene scene;
  scene.world.gravity.setZero();
  scene.robots = {part("finger", model, Vec3(-0.04, 0, 0.0056))};
  scene.robots[0].params.drives = {{.kp = 50, .kd = 0.5, .effort = effort}};
  scene.robots[0].motions = {stand("hinge", 0.06)};
  return scene;
}
}  // namespace

TEST(Exchange, AFloatingRobotAndAStripKeepTheirMomentum) {
  Coupled both(free_strip(0.005, 1e-9), two_links(Vec3(0.05, 0, -0.3)));
  const Vec3 before = 0.008 * Vec3(0.05, 0, -0.3);
  Real given = 0;
  int measured = 0;
  for (int k = 0; k < 12; ++k) {
    ASSERT_TRUE(both.step()) << both.report.failure;
    const Vec3 now = both.bullet().generalized_momentum(0).head<3>();
    ASSERT_LT((both.report.momentum + now - before).norm(), 1e-9 * before.norm()) << k;
    EXPECT_LT(both.stepper->exchange().residual.value_or(0), 1e-9) << k;
    measured += both.stepper->exchange().residual.has_value() ? 1 : 0;
    given += both.stepper->exchange().momentum_given;
  }
  EXPECT_GE(measured, 5) << "steps in which they touched";
  EXPECT_GT(given, 0.02 * before.norm());
  EXPECT_GT(both.report.momentum.norm(), 0.02 * before.norm());
}
/// A block on three slides, which drives push into a free strip in space and along it. What its momentum along the slides gains by the
/// tape's forces, beyond what they make the drives add, the strip has lost.
TEST(Exchange, ARobotOnAFixedBaseReceivesWhatTheStripLoses) {
  const auto slide = [](const char* name, const Vec3& axis, int parent) {
    robot::Joint j = joint(name, robot::JointType::prismatic, axis, Vec3::Zero());
    j.parent = parent;
    return j;
  };
  const robot::Inertial light{0.01, Vec3::Zero(), 1e-6 * robot::Mat3::Identity()};
  RobotModel model{.name = "gantry"};
  model.links = {{.name = "rail"},
                 {.name = "bridge", .inertial = light},
                 {.name = "trolley", .inertial = light},
                 box_link("block", 0.02, Vec3(0.012, 0.012, 0.01))};
  model.joints = {slide("x", Vec3::UnitX(), 0), slide("y", Vec3::UnitY(), 1), slide("z", Vec3::UnitZ(), 2)};
  RobotScene scene;
  scene.world.gravity.setZero();
  scene.robots = {part("gantry", model, Vec3(-0.01, 0.001, 0.0056))};
  scene.robots[0].params.drives = {{.kp = 200, .kd = 4}, {.kp = 200, .kd = 4}, {.kp = 200, .kd = 4}};
  scene.robots[0].motions = {stand("x", 0.01), stand("y", 0.002), stand("z", -0.006)};
  constexpr Real kStep = 0.005;
  Coupled both(free_strip(kStep, 1e-9), scene);
  const auto momentum = [&](const robot::World& world) -> Vec3 {
    return world.generalized_momentum(0) - kStep * world.drive_effort(0);  // the masses that move along each slide are always the same
  };
  Vec3 strip = Vec3::Zero();
  Real across = 0, along = 0;
  for (int k = 0; k < 12; ++k) {
    robot::World alone = make_world(scene);
    if (k > 0) alone.restore(both.bullet().save());
    ASSERT_TRUE(both.step()) << both.report.failure;
    const Vec3 lost = strip - both.report.momentum;
    strip = both.report.momentum;
    if (k == 0) continue;  // drives are told where to go
    alone.step(kStep);
    const Vec3 received = momentum(both.bullet()) - momentum(alone);
    ASSERT_LE((received - lost).norm(), 1e-9 * lost.norm() + 1e-16) << k;
    across = std::fmax(across, lost.z()), along = std::fmax(along, std::fabs(lost.x()));
  }
  EXPECT_GT(across, 1e-6) << "[N s]";
  EXPECT_GT(along, 1e-6) << "[N s]";
}
TEST(Exchange, BulletAloneGoesItsWayWhereNoTapeIs) {
  RobotScene far = two_links(Vec3(0.05, 0, 0.3), {{.kp = 0.1, .kd = 1e-4}});
  far.robots[0].motions = {stand("hinge", 0.4)};
  Coupled both(free_strip(0.01, 1e-3), far);
  robot::World alone = make_world(far);
  for (int k = 0; k < 10; ++k) {
    ASSERT_TRUE(both.step()) << both.report.failure;
    alone.step(0.01);
    ASSERT_EQ(alone.save().numbers, both.bullet().save().numbers) << k;
    EXPECT_LT(both.stepper->exchange().mismatch, 1e-9) << k;
  }
  EXPECT_GT(alone.state(0).q[0], 0.05);
}
TEST(Exchange, DrivesAreToldWhereToBeAHundredTimesASecondInLongerStepsToo) {
  RobotScene far = two_links(Vec3(0.05, 0, 0.3), {{.kp = 0.1, .kd = 1e-4}});
  far.robots[0].motions = {{[](const robot::VecX&) {
                              return robot::JointTrajectory{
                                  .joints = {"hinge"}, .times = {0, 0.2}, .knots = {robot::VecX::Zero(1), robot::VecX::Constant(1, 0.8)}};
                            },
                            0, 0.2}};
  Coupled coarse(free_strip(0.04, 1e-3), far), fine(free_strip(0.01, 1e-3), far);
  for (int k = 0; k < 5; ++k) {
    ASSERT_TRUE(coarse.step()) << coarse.report.failure;
    for (int part = 0; part < 4; ++part) ASSERT_TRUE(fine.step()) << fine.report.failure;
    EXPECT_NEAR(coarse.bullet().state(0).q[0], fine.bullet().state(0).q[0], 1e-12) << k;
    EXPECT_NEAR(coarse.bullet().state(0).v[6], fine.bullet().state(0).v[6], 1e-10) << k;
  }
  EXPECT_GT(fine.bullet().state(0).q[0], 0.1);
}
TEST(Exchange, RunsRepeatToTheBitAndGoOnFromAState) {
  const RobotScene scene = two_links(Vec3(0.05, 0, -0.3));
  Coupled first(free_strip(0.005, 1e-4), scene);
  tape::State half;
  for (int k = 0; k < 8; ++k) {
    ASSERT_TRUE(first.step());
    if (k == 3) half = first.state;
  }
  for (int threads : {1, 2, 8}) {
    tape::set_threads(threads);
    Coupled again(free_strip(0.005, 1e-4), scene), resumed(free_strip(0.005, 1e-4), scene);
    for (int k = 0; k < 8; ++k) ASSERT_TRUE(again.step());
    resumed.state = half;
    for (int k = 4; k < 8; ++k) ASSERT_TRUE(resumed.step());
    EXPECT_EQ(again.state.hash(), first.state.hash()) << threads;
    EXPECT_EQ(resumed.state.hash(), first.state.hash()) << threads;
  }
  tape::set_threads(0);
  first.state.outside.pop_back();
  EXPECT_THROW(first.step(), tape::InputError);
}
/// The finger meets a strip that two grips hold.
TEST(Exchange, ADrivenFingerGivesWayAsItsDriveAloneWould) {
  const RobotScene scene = finger();
  tape::Setup setup = free_strip(0.01, 1e-6);
  setup.scene.grips = {tape::test::hold("left", {0, 1, 2, 3})};
  const int last = static_cast<int>(tape::World::build(setup).assembly.x.size());
  setup.scene.grips.push_back(tape::test::hold("right", {last - 4, last - 3, last - 2, last - 1}));
  Coupled both(setup, scene);
  for (int k = 0; k < 30; ++k) {
    const robot::Snapshot start = both.bullet().save();
    robot::World alone = make_world(scene), pushed = make_world(scene);
    ASSERT_TRUE(both.step()) << both.report.failure;
    if (k > 0) alone.restore(start), pushed.restore(start);
    const Real q0 = alone.state(0).q[0];
    alone.step(0.01);
    pushed.step(0.01, {both.report.articulations[0].force.head(1)});
    const Real moved = both.report.articulations[0].q[0], course = alone.state(0).q[0] - q0, answer = pushed.state(0).q[0] - q0;
    // What the tape solve gave way by is what the drive gives way by.
    EXPECT_NEAR(moved - course, answer - course, 0.01 * std::fabs(answer - course) + 1e-12) << k;
  }
  const Real torque = both.report.articulations[0].force[0];
  EXPECT_LT(torque, -0.002);
  EXPECT_NEAR(both.bullet().state(0).q[0] - 0.06, torque / 50, 0.01 * std::fabs(torque) / 50);  // at rest: the drive's spring
}
/// 5 N on a pad on a slide, on tape, on a box that stands still.
TEST(Exchange, APadPressesTheTapeWithItsDrivesForce) {
  RobotModel model{.name = "press"};
  model.links = {{.name = "rail"}, box_link("pad", 0.05, Vec3(0.012, 0.012, 0.01))};
  model.joints = {joint("slide", robot::JointType::prismatic, -Vec3::UnitZ(), Vec3::Zero())};
  RobotScene scene;
  scene.robots = {part("press", model, Vec3(0, 0, 0.0056))};
  scene.robots[0].push = {5 - 0.05 * 9.81};
  tape::Setup setup = free_strip(0.01, 1e-4);
  setup.scene.gravity = Vec3(0, 0, -9.81);
  tape::test::add_body(setup, "box", tape::box_mesh(Vec3(0.1, 0.05, 0.02)), tape::Motion::fixed, Vec3(0, 0, -0.0103));
  Coupled both(setup, scene);
  for (int k = 0; k < 40; ++k) ASSERT_TRUE(both.step()) << both.report.failure;
  EXPECT_NEAR(both.link(0, 0).normal.force.z(), 5, 0.02 * 5);
}
/// A ram on a slide, a strip and a plate on a slide of its own, without weight: the ram pushes with 5 N.
struct Ram {
  std::unique_ptr<Coupled> both;
  explicit Ram(double mass, const robot::Joint& slide) {
    const auto along = [](const char* name, double kilograms, const Vec3& size, const robot::Joint& j) {
      RobotModel model{.name = name};
      model.links = {{.name = "rail"}, box_link("block", kilograms, size)};
      model.joints = {j};
      return model;
    };
    RobotScene scene;
    scene.world.gravity.setZero();
    scene.robots = {part("ram", along("ram", 2 * mass, Vec3(0.012, 0.012, 0.01), joint("slide", slide.type, -Vec3::UnitZ(), Vec3::Zero())),
                         Vec3(0, 0, 0.0056)),
                    part("plate", along("plate", mass, Vec3(0.03, 0.03, 0.01), slide), Vec3(0, 0, -0.0056))};
    scene.robots[0].push = {5};
    both = std::make_unique<Coupled>(free_strip(0.01, 1e-4), scene);
  }
  void step() { ASSERT_TRUE(both->step()) << both->report.failure; }
  Real force() const { return both->link(0, 0).normal.force.z(); }
};
robot::Joint upward_slide() { return joint("slide", robot::JointType::prismatic, Vec3::UnitZ(), Vec3::Zero()); }
/// The tape solver is told what Bullet knows of a joint: else the plate would give way to it and come back step by step.
TEST(Exchange, WhatFrictionOrALimitHoldsBearsThePressAtOnce) {
  robot::Joint sticks = upward_slide(), stops = upward_slide();
  sticks.friction = 10;
  stops.lower = 0, stops.upper = 0.01, stops.damping = 2;  // or it bounces
  for (const robot::Joint& slide : {sticks, stops}) {
    Ram ram(0.02, slide);
    for (int k = 0; k < 30; ++k) ram.step();
    EXPECT_NEAR(ram.force(), 5, 0.02 * 5) << "friction " << slide.friction;
    EXPECT_LT(ram.both->report.link_mismatch, 1e-5);
  }
}
/// Friction of 3 N under a plate of 1 kg gives way to a ram of 2 kg: they move on together by (5 - 3)/3 m/s^2.
TEST(Exchange, FrictionThatIsOvercomeGoesOnBraking) {
  robot::Joint slide = upward_slide();
  slide.friction = 3;
  Ram ram(1, slide);
  Real mean = 0, speed = 0;
  for (int k = 0; k < 30; ++k) {
    ram.step();
    if (k == 9) speed = ram.both->bullet().state(1).v[0];
    if (k >= 10) mean += ram.force() / 20;
  }
  EXPECT_NEAR(mean, 3 + 2.0 / 3, 0.02 * 3);
  EXPECT_NEAR(ram.both->bullet().state(1).v[0] - speed, -0.2 * 2 / 3, 0.05 * 0.2 * 2 / 3);
}
/// The finger again, with a box under the strip: its drive comes to its limit as soon as it presses.
TEST(Exchange, ADriveAtItsLimitPressesWithThat) {
  constexpr Real kLimit = 0.05;  // [N m], 1.25 N at the tip
  const RobotScene scene = finger(kLimit);
  tape::Setup setup = free_strip(0.01, 1e-5);
  tape::test::add_body(setup, "box", tape::box_mesh(Vec3(0.1, 0.05, 0.02)), tape::Motion::fixed, Vec3(0, 0, -0.0103));
  Coupled both(setup, scene);
  Real mean = 0;
  for (int k = 0; k < 40; ++k) {
    ASSERT_TRUE(both.step()) << both.report.failure;
    EXPECT_GT(both.report.min_gap, 0);
    EXPECT_LT(std::fabs(both.report.articulations[0].force[0]), 1.5 * kLimit) << k << ": it does not bounce";
    if (k >= 20) mean += both.report.articulations[0].force[0] / 20;
  }
  EXPECT_NEAR(mean, -kLimit, 0.02 * kLimit);
}
/// A gripper whose second pad follows the first one, which has a drive without a limit; in the file either may come first.
TEST(Exchange, APadThatFollowsAnotherPressesWithTheirDrivesForce) {
  constexpr Real kStiff = 1e4;
  for (const int lead : {0, 1}) {
    const int follower = 1 - lead;
    RobotModel model{.name = "gripper"};
    model.links = {{.name = "base"}, box_link("one", 0.02, Vec3(0.012, 0.012, 0.01)), box_link("two", 0.02, Vec3(0.012, 0.012, 0.01))};
    model.joints = {joint("one", robot::JointType::prismatic, -Vec3::UnitZ(), Vec3(0, 0, 0.0065)),
                    joint("two", robot::JointType::prismatic, Vec3::UnitZ(), Vec3(0, 0, -0.0065))};
    model.joints[1].parent = 0;
    model.joints[static_cast<std::size_t>(follower)].mimic = robot::Mimic{.joint = lead};
    RobotScene scene;
    scene.world.gravity.setZero();
    scene.robots = {part("gripper", model, Vec3::Zero())};
    scene.robots[0].params.drives = {{.kp = kStiff, .kd = 100}, {.kp = kStiff, .kd = 100}};
    scene.robots[0].motions = {stand(lead == 0 ? "one" : "two", 0.003)};
    tape::Setup setup = free_strip(0.01, 1e-4);
    setup.scene.contact.kappa = 1e5;
    Coupled both(setup, scene);
    for (int k = 0; k < 12; ++k) ASSERT_TRUE(both.step()) << k << ": " << both.report.failure;
    const Real drive = kStiff * (0.003 - both.bullet().state(0).q[lead]);  // shared by both pads
    EXPECT_GT(drive, 5) << lead;
    EXPECT_NEAR(both.link(0, 0).normal.force.z(), drive / 2, 0.02 * drive) << lead;
    EXPECT_NEAR(both.link(0, 1).normal.force.z(), -drive / 2, 0.02 * drive) << lead;
  }
}
TEST(Exchange, ARecordOfAStateThatAnotherStepperHasMadeShowsThatState) {
  const RobotScene scene = finger();
  Coupled first(free_strip(0.01, 1e-4), scene);
  for (int k = 0; k < 5; ++k) ASSERT_TRUE(first.step());
  const Coupled fresh(free_strip(0.01, 1e-4), scene);
  const cosim::RobotRecord known = first.stepper->records(first.state)[0], found = fresh.stepper->records(first.state)[0];
  EXPECT_GT(known.position[0], 1e-3);
  EXPECT_EQ(found.position, known.position);
  EXPECT_EQ(found.velocity, known.velocity);
  EXPECT_EQ(found.command, known.command);
  EXPECT_EQ(fresh.stepper->records(fresh.state)[0].position[0], 0);
}
/// Two pads on slides close on a strip with 10 N each and open again.
TEST(Exchange, PadsPinchAStripWithTheirDrivesForceAndLetGo) {
  RobotModel model{.name = "gripper"};
  model.links = {{.name = "base"}, box_link("upper", 0.02, Vec3(0.012, 0.012, 0.01)), box_link("lower", 0.02, Vec3(0.012, 0.012, 0.01))};
  model.joints = {joint("up", robot::JointType::prismatic, -Vec3::UnitZ(), Vec3(0, 0, 0.0065)),
                  joint("down", robot::JointType::prismatic, Vec3::UnitZ(), Vec3(0, 0, -0.0065))};
  model.joints[1].parent = 0;
  RobotScene scene;
  scene.world.gravity.setZero();
  scene.robots = {part("gripper", model, Vec3::Zero())};
  scene.robots[0].params.drives = {{.kp = 1e4, .kd = 100, .effort = 10}, {.kp = 1e4, .kd = 100, .effort = 10}};
  const auto go = [](const char* name, double to, double start) {
    cosim::RobotMotion motion = stand(name, to);
    motion.start = start;
    return motion;
  };
  scene.robots[0].motions = {go("up", 0.003, 0), go("down", 0.003, 0), go("up", -0.004, 0.3), go("down", -0.004, 0.3)};
  tape::Setup setup = free_strip(0.01, 1e-4);
  setup.scene.contact.kappa = 1e5;
  Coupled both(setup, scene);
  int pinching = 0;
  for (int k = 0; k < 45; ++k) {
    ASSERT_TRUE(both.step()) << k << ": " << both.report.failure;
    EXPECT_GT(both.report.min_gap, 0) << k;
    pinching += both.stepper->exchange().pinching;
    if (k != 28) continue;
    EXPECT_NEAR(both.link(0, 0).normal.force.z(), 10, 0.2);
    EXPECT_NEAR(both.link(0, 1).normal.force.z(), -10, 0.2);
  }
  EXPECT_GT(pinching, 20) << "steps in which the pads touch on the tape side";
  EXPECT_EQ(both.link(0, 0).normal.force.norm() + both.link(0, 1).normal.force.norm(), 0);
}
/// Two pads of 2 N each on a wrist that a soft drive draws along a strip that is held at its other end: by 2 mm it holds, by 8 it slips.
TEST(Exchange, APinchPullsWithWhatTheStripPullsBackAndSlipsWhereFrictionEnds) {
  constexpr Real kPress = 2, kSpring = 500, kMu = 0.5;
  RobotModel model{.name = "gripper"};
  model.links = {{.name = "base"},
                 {.name = "wrist", .inertial = {0.05, Vec3::Zero(), 1e-5 * robot::Mat3::Identity()}},
                 box_link("upper", 0.02, Vec3(0.012, 0.03, 0.01)),
                 box_link("lower", 0.02, Vec3(0.012, 0.03, 0.01))};
  model.joints = {joint("pull", robot::JointType::prismatic, Vec3::UnitX(), Vec3::Zero()),
                  joint("up", robot::JointType::prismatic, -Vec3::UnitZ(), Vec3(0, 0, 0.0065)),
                  joint("down", robot::JointType::prismatic, Vec3::UnitZ(), Vec3(0, 0, -0.0065))};
  model.joints[1].parent = model.joints[2].parent = 1;
  model.joints[1].damping = model.joints[2].damping =
      20;  // N s/m: else what presses with a constant force swings from step to step (README.md)
  RobotScene scene;
  scene.world.gravity.setZero();
  scene.robots = {part("gripper", model, Vec3(0.018, 0, 0))};
  scene.robots[0].params.drives = {
      {.kp = kSpring, .kd = 20}, {.kp = 1e4, .kd = 100, .effort = kPress}, {.kp = 1e4, .kd = 100, .effort = kPress}};
  const auto go = [](const char* name, double to, double start) {
    cosim::RobotMotion motion = stand(name, to);
    motion.start = start;
    return motion;
  };
  scene.robots[0].motions = {go("up", 0.003, 0), go("down", 0.003, 0), go("pull", 0.002, 0.15), go("pull", 0.008, 0.4)};
  tape::Setup setup = free_strip(0.01, 1e-4);
  setup.scene.materials[0].mu = kMu;
  setup.scene.contact.kappa = 1e5;
  setup.scene.grips = {tape::test::hold("left", {0, 1, 2, 3})};
  Coupled both(setup, scene);
  const auto along = [&](std::size_t pad) { return both.link(0, pad).normal.force.x() + both.link(0, pad).friction.force.x(); };
  Real pulled = 0, held = 0, slipping = 0, pressing = 0, moved = 0;
  for (int k = 0; k < 70; ++k) {
    ASSERT_TRUE(both.step()) << k << ": " << both.report.failure;
    if (k >= 29 && k < 39) pulled += along(0) + along(1), held += both.report.grip_force[0].x();
    if (k == 38) moved = both.bullet().state(0).q[0];
    if (k >= 60) slipping += along(0) + along(1), pressing += both.link(0, 0).normal.force.z() - both.link(0, 1).normal.force.z();
  }
  EXPECT_NEAR(pulled, held, 0.02 * std::fabs(held)) << "the fingers feel what the strip pulls with";
  EXPECT_NEAR(pulled / 10, -kSpring * (0.002 - moved), 0.02 * kSpring * 0.002);
  EXPECT_NEAR(pressing / 10, 2 * kPress, 0.02 * 2 * kPress);
  EXPECT_NEAR(slipping / 10, -2 * kMu * kPress, 0.02 * 2 * kMu * kPress);
  EXPECT_GT(both.bullet().state(0).q[0] - moved, 0.002) << "it has slipped";
}
/// A block over a plate, so near that they touch in Bullet, and a strip within 2 mm of both, which touches neither.
TEST(Exchange, APairGoesOverToTheTapeSolverOnlyWhereTheBarrierDoesNotActYet) {
  const Real dhat = tape::test::vinyl().dhat;
  for (const Real gap : {0.3 * dhat, 0.9 * dhat, 1.1 * dhat}) {
    RobotModel block{.name = "block"}, plate{.name = "plate"};
    block.links = {box_link("block", 0.02, Vec3::Constant(0.012))};
    plate.links = {box_link("plate", 1, Vec3(0.1, 0.08, 0.02))};
    RobotScene scene;
    scene.world.gravity.setZero();
    scene.robots = {part("plate", plate, Vec3(0, 0, -0.0115)), part("block", block, Vec3(0, 0.0165, -0.0015 + 0.006 + gap), false)};
    Coupled both(free_strip(0.01, 1e-4), scene);
    ASSERT_TRUE(both.step()) << both.report.failure;
    EXPECT_EQ(both.stepper->exchange().pinching, gap > dhat ? 1 : 0) << gap;
    EXPECT_EQ(both.link(0, 0).normal.force.norm(), 0) << gap << ": nothing presses them together";
  }
}
TEST(Exchange, ThingsThatStartDeepInsideEachOtherAreRefusedByName) {
  RobotModel block{.name = "block"}, plate{.name = "plate"};
  block.links = {box_link("cube", 0.02, Vec3::Constant(0.012))};
  plate.links = {box_link("slab", 1, Vec3(0.1, 0.08, 0.02))};
  RobotScene scene;
  const auto sunk = [&](double depth) {
    scene.robots = {part("plate", plate, Vec3(0, 0, -0.01)), part("block", block, Vec3(0, 0, 0.006 - depth), false)};
    return cosim::make_world(scene);
  };
  EXPECT_NO_THROW(sunk(0.004));
  EXPECT_THAT([&] { sunk(0.007); }, testing::ThrowsMessage<tape::InputError>(
                                        testing::AllOf(testing::HasSubstr("plate:slab"), testing::HasSubstr("block:cube"),
                                                       testing::HasSubstr("7.0 mm"), testing::HasSubstr("allowed: 5.0 mm"))));
}
/// As of robots whose models do not quite fit together, and come without an SRDF file.
TEST(Exchange, LinksOfOneRobotThatStartInsideEachOtherDoNotTouch) {
  RobotModel model{.name = "arm"};
  model.links = {
      {.name = "base"}, box_link("first", 0.1, Vec3::Constant(0.02)), box_link("second", 0.1, Vec3::Constant(0.02), Vec3(0.015, 0, 0))};
  model.joints = {joint("one", robot::JointType::continuous, Vec3::UnitY(), Vec3::Zero()),
                  joint("two", robot::JointType::continuous, Vec3::UnitY(), Vec3::Zero())};
  model.joints[0].parent = model.joints[1].parent = 0;
  RobotScene scene;
  scene.world.gravity.setZero();
  scene.robots = {part("arm", model, Vec3(0, 0, 0.1))};
  EXPECT_FALSE(cosim::make_world(scene).may_touch(0, 1, 0, 2));
  EXPECT_THAT(cosim::notes_on(scene), testing::ElementsAre(testing::HasSubstr("arm:first and arm:second start 5.0 mm inside each other")));
  scene.robots[0].params.drives = {{.kp = 5, .kd = 0.1}, {.kp = 5, .kd = 0.1}};
  Coupled both(free_strip(0.01, 1e-4), scene);
  for (int k = 0; k < 5; ++k) ASSERT_TRUE(both.step()) << both.report.failure;
  EXPECT_LT(both.bullet().state(0).q.norm(), 1e-9) << "nothing pushes them";
}
TEST(Exchange, PosedLinksAreWhereTheyAreToldToBeWhateverTheyPush) {
  RobotScene scene = finger();
  scene.exchange.schedule = Schedule::posed;
  scene.world.gravity = Vec3(0, 0, -9.81);  // no drive has to bear it
  scene.robots[0].motions = {{[](const robot::VecX&) {
                                return robot::JointTrajectory{
                                    .joints = {"hinge"},
                                    .times = {0, 0.05, 0.1},
                                    .knots = {robot::VecX::Zero(1), robot::VecX::Constant(1, 0.01), robot::VecX::Constant(1, 0.06)},
                                    .between = robot::JointTrajectory::Between::linear};
                              },
                              0, 0.1}};
  Coupled both(free_strip(0.01, 1e-4), scene);
  for (int k = 1; k <= 12; ++k) {
    ASSERT_TRUE(both.step()) << both.report.failure;
    const Real t = 0.01 * k, told = t < 0.05 ? 0.2 * t : std::min(0.06, 0.01 + (t - 0.05));
    EXPECT_NEAR(both.bullet().state(0).q[0], told, 1e-12) << k;
    EXPECT_NEAR(both.bullet().state(0).v[0], k <= 5 ? 0.2 : k <= 10 ? 1 : 0, 1e-9) << k;
    EXPECT_LT(both.stepper->exchange().mismatch, 1e-6) << k;
    EXPECT_EQ(both.bullet().drive_effort(0).norm(), 0);
  }
  EXPECT_LT(both.report.momentum.z(), 0) << "the strip has been pushed down";
}
