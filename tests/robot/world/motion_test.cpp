// Motion against closed forms.
#include <gtest/gtest.h>

#include "tests/robot/world/robots.hpp"
using namespace robot;
using namespace robot::test;

namespace {
const Model kTree = std::make_shared<RobotModel>(tree());
constexpr Real kPi = std::numbers::pi;
}  // namespace

TEST(Motion, AFallingBoxIsWhereTheSumOfItsSubstepsSays) {
  World world;
  const int robot = world.add_robot(box({0.1, 0.2, 0.3}, 2), {.fixed_base = false});
  for (int i = 0; i < 50; ++i) world.step(0.01);
  const RobotState s = world.state(robot);
  constexpr Real kH = 1e-3, kG = 9.81, kN = 500;  // z_n = -g h^2 n (n + 1) / 2
  EXPECT_NEAR(s.X_WB.translation().z(), -kG * kH * kH * kN * (kN + 1) / 2, 1e-12);
  EXPECT_NEAR(s.v[2], -kG * 0.5, 1e-12);
  EXPECT_TRUE(s.X_WB.linear().isApprox(Mat3::Identity(), 1e-15));
}

TEST(Motion, APendulumOfAnyInertiaSwingsWithItsPeriod) {
  const Vec3 axis = Vec3(1, 2, 0.5).normalized();
  const Inertial inertial = lopsided(1.3, {0.02, 0.05, -0.2});
  World world;
  const int robot = world.add_robot(one_joint(JointType::revolute, axis, inertial));
  // theta'' = -dU/dtheta / I about the axis; by components across the axis
  const Vec3 r = inertial.com - axis.dot(inertial.com) * axis;
  const Real inertia = axis.dot(inertial.inertia * axis) + inertial.mass * r.squaredNorm();
  const Vec3 g = Vec3(0, 0, -9.81) - axis.dot(Vec3(0, 0, -9.81)) * axis;
  const Real rest = std::atan2(axis.dot(r.cross(g)), r.dot(g));
  const Real period = 2 * kPi * std::sqrt(inertia / (inertial.mass * g.norm() * r.norm()));
  constexpr Real kAmplitude = 0.01;  // lengthens the period by 1 + amplitude^2 / 16
  world.set_state(robot, {Pose::Identity(), VecX::Constant(1, rest + kAmplitude), VecX::Zero(1)});
  constexpr int kPeriods = 10;
  int crossings = 0;
  Real time = 0, last = kAmplitude, crossed = 0, first = 0;
  while (crossings <= 2 * kPeriods) {
    world.step(1e-3);
    time += 1e-3;
    const Real now = world.state(robot).q[0] - rest;
    if ((now < 0) != (last < 0)) {
      crossed = time - 1e-3 * now / (now - last);
      if (crossings == 0) first = crossed;
      ++crossings;
    }
    last = now;
  }
  EXPECT_NEAR((crossed - first) / kPeriods, period * (1 + kAmplitude * kAmplitude / 16), 1e-5 * period);
  EXPECT_LT(std::abs(last), kAmplitude);
}

TEST(Motion, AChainThatSwingsFreelyKeepsItsEnergy) {
  RobotModel chain{.name = "chain"};
  chain.links = {{.name = "stand"}};
  for (int k = 0; k < 3; ++k) {
    chain.links.push_back({.name = "link", .inertial = lopsided(0.5, {0.02, 0, -0.1})});
    chain.joints.push_back(
        {.name = "joint", .parent = k, .X_PJ = at({0, 0, k > 0 ? -0.2 : 0.0}, 0.2 * k, {1, 1, 0}), .axis = Vec3::UnitY()});
  }
  World world;
  const int robot = world.add_robot(std::make_shared<RobotModel>(chain));
  world.set_state(robot, {Pose::Identity(), VecX::Constant(3, 1.2), VecX::Zero(3)});
  const auto potential = [&] {
    Real sum = 0;
    for (int link = 1; link <= 3; ++link)
      sum += 0.5 * 9.81 * (world.link_pose(robot, link) * chain.links[static_cast<std::size_t>(link)].inertial.com).z();
    return sum;
  };
  const Real start = potential();
  Real scale = 0, drift = 0;
  constexpr int kSteps = 500, kMean = 200;  // a momentary error has velocity and position half a substep apart
  for (int i = 0; i < kSteps; ++i) {
    world.step(0.01);
    const Real kinetic = kinetic_energy(world, robot);
    scale = std::max(scale, kinetic);
    if (i >= kSteps - kMean) drift += (kinetic + potential() - start) / kMean;
  }
  EXPECT_LT(std::abs(drift), 0.005 * scale);  // Coriolis forces at the start of the substep take 5 %
}

TEST(Motion, AFreeRobotsMomentumChangesByTheExternalImpulseAlone) {
  World world({.gravity = Vec3::Zero()});
  const int robot =
      world.add_robot(kTree, {.fixed_base = false, .drives = std::vector<DriveGains>(5, {.kp = 20, .kd = 0.1, .effort = 0.5})});
  std::vector<JointCommand> commands(5, {.kind = JointCommand::Kind::position, .position = 0.3});
  world.command(robot, commands);
  world.set_state(robot, odd_state(world, robot, 2));
  for (int i = 0; i < 100; ++i) {
    const auto [p0, l0] = momentum(world, robot);
    VecX tau = odd_numbers(world.dof(robot), 0.8 * std::cos(0.1 * i));
    const Vec3 origin = world.state(robot).X_WB.translation();
    constexpr Real kDt = 1e-3;  // one substep: the base's force works where the base is at its start
    world.step(kDt, {tau});
    const auto [p1, l1] = momentum(world, robot);
    EXPECT_LT((p1 - p0 - kDt * tau.head<3>()).norm(), 1e-12 * p0.norm());
    EXPECT_LT((l1 - l0 - kDt * (tau.segment<3>(3) + origin.cross(tau.head<3>()))).norm(), 1e-12 * l0.norm());
  }
}

TEST(Motion, ATumblingBoxKeepsItsEnergy) {
  World world({.gravity = Vec3::Zero()});
  const int robot = world.add_robot(box({0.1, 0.2, 0.3}, 2), {.fixed_base = false});
  VecX v = VecX::Zero(6);
  v.tail<3>() << 0.5, 5, 0.3;  // about the middle axis: it flips over and over
  world.set_state(robot, {at({1, 0, 0}), VecX(0), v});
  const Real start = kinetic_energy(world, robot);
  Real worst = 0;
  for (int i = 0; i < 300; ++i) {
    world.step(0.01);
    worst = std::max(worst, std::abs(kinetic_energy(world, robot) / start - 1));
  }
  EXPECT_LT(worst, 1e-6);  // (h omega)^2 = 2.5e-5; a first-order turn is wrong by 5e-3
}

TEST(Motion, JointFrictionHoldsBelowItsTorqueAndLetsSlideAbove) {
  constexpr Real kFriction = 0.7, kInertia = 0.02, kCreep = 1e-7;  // [rad/s] of what sticks, at most
  const Inertial wheel{1, Vec3::Zero(), kInertia * Mat3::Identity()};
  World world;
  const int robot = world.add_robot(one_joint(JointType::revolute, Vec3::UnitZ(), wheel, {.name = "joint", .friction = kFriction}));
  for (int i = 0; i < 20; ++i) world.step(0.01, {VecX::Constant(1, 0.99 * kFriction)});
  EXPECT_NEAR(world.state(robot).q[0], 0, 0.2 * kCreep);
  for (int i = 0; i < 20; ++i) world.step(0.01, {VecX::Constant(1, 1.5 * kFriction)});
  EXPECT_NEAR(world.state(robot).v[0], 0.2 * 0.5 * kFriction / kInertia, kCreep);
  for (int i = 0; i < 30; ++i) world.step(0.01);  // 0.1 s more than it takes to stop
  EXPECT_NEAR(world.state(robot).v[0], 0, 1e-12);
}

TEST(Motion, JointDampingIsImplicit) {
  constexpr Real kDamping = 50, kInertia = 0.02, kH = 1e-3;  // h damping / inertia = 2.5: explicit would blow up
  const Inertial wheel{1, Vec3::Zero(), kInertia * Mat3::Identity()};
  World world;
  const int robot = world.add_robot(one_joint(JointType::revolute, Vec3::UnitZ(), wheel, {.name = "joint", .damping = kDamping}));
  world.set_state(robot, {Pose::Identity(), VecX::Zero(1), VecX::Constant(1, 3)});
  world.step(5e-3);
  EXPECT_NEAR(world.state(robot).v[0], 3 * std::pow(1 + kH * kDamping / kInertia, -5), 1e-14);
}

TEST(Motion, JointLimitsHold) {
  const Inertial wheel{1, Vec3::Zero(), 0.02 * Mat3::Identity()};
  World world;
  const int robot = world.add_robot(one_joint(JointType::revolute, Vec3::UnitZ(), wheel, {.name = "joint", .lower = -0.5, .upper = 0.3}));
  for (const Real side : {1.0, -1.0}) {
    for (int i = 0; i < 100; ++i) world.step(0.01, {VecX::Constant(1, side * 0.4)});
    EXPECT_NEAR(world.state(robot).q[0], side > 0 ? 0.3 : -0.5, 1e-4);
    EXPECT_NEAR(world.state(robot).v[0], 0, 1e-2);
  }
}

TEST(Motion, AMimickingJointFollowsUnderLoad) {
  RobotModel hand{.name = "hand"};
  hand.links = {{.name = "palm"},
                {.name = "finger", .inertial = lopsided(0.02, {0, 0, 0.03})},
                {.name = "tip", .inertial = lopsided(0.01, {0, 0, 0.02})}};
  hand.joints = {{.name = "mcp", .parent = 0}, {.name = "pip", .parent = 1, .X_PJ = at({0, 0, 0.05}), .mimic = Mimic{0, 1.3, 0.1}}};
  World world;
  const int robot = world.add_robot(std::make_shared<RobotModel>(hand), {.drives = {{.kp = 50, .kd = 1}, {}}});
  EXPECT_NEAR(world.state(robot).q[1], 0.1, 1e-15);
  world.command(robot, {{.kind = JointCommand::Kind::position, .position = 0.8}, {}});
  for (int i = 0; i < 200; ++i) {
    VecX load(2);
    load << 0.1, -2 * std::sin(0.2 * i);
    world.step(0.01, {load});
    const VecX q = world.state(robot).q;
    EXPECT_NEAR(q[1], 1.3 * q[0] + 0.1, 1e-13);
  }
  for (int i = 0; i < 300; ++i) world.step(0.01, {VecX::Unit(2, 1)});  // virtual work: 1 N m on the follower is 1.3 on the leader
  const RobotState s = world.state(robot);
  VecX tau(2);
  tau << world.drive_effort(robot)[0], 1;
  EXPECT_NEAR(world.motions(robot).col(0).dot(world.mass_matrix(robot) * world.acceleration(robot, tau)), 0, 1e-9);
}
