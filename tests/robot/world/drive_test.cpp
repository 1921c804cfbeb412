// Drives, and what a robot on drives does under forces and contacts.
#include <gtest/gtest.h>

#include "tests/robot/world/robots.hpp"
using namespace robot;
using namespace robot::test;

namespace {
constexpr Real kInertia = 0.02, kH = 1e-3;
const Inertial kWheel{1, Vec3::Zero(), kInertia* Mat3::Identity()};
const Model kHinge = one_joint(JointType::revolute, Vec3::UnitZ(), kWheel);
const Model kTree = std::make_shared<RobotModel>(tree());
using Kind = JointCommand::Kind;

/// Stiff enough that h kd and h^2 kp count beside the inertia.
const std::vector<DriveGains> kStiff(5, {.kp = 2000, .kd = 40});
std::vector<JointCommand> hold(const VecX& q) {
  std::vector<JointCommand> commands;
  for (const Real position : q) commands.push_back({.kind = Kind::position, .position = position});
  return commands;
}
/// Coordinates that world.state(0) is at, from `from`: base displacement and turn, then joints.
VecX displacement(const RobotState& from, const RobotState& to, bool fixed) {
  if (fixed) return to.q - from.q;
  VecX d(6 + to.q.size());
  const Eigen::AngleAxisd turn(Mat3(to.X_WB.linear() * from.X_WB.linear().transpose()));
  d << to.X_WB.translation() - from.X_WB.translation(), turn.angle() * turn.axis(), to.q - from.q;
  return d;
}
}  // namespace

TEST(Drive, AStepOfTheTargetIsAnsweredByTheImplicitRecurrence) {
  constexpr Real kKp = 300, kKd = 6, kTarget = 0.4, kRate = 0.1;
  World world;
  const int robot = world.add_robot(kHinge, {.drives = {{.kp = kKp, .kd = kKd}}});
  world.command(robot, {{.kind = Kind::position, .position = kTarget, .velocity = kRate, .effort = 0.3}});
  Real q = 0, v = 0;
  for (int i = 0; i < 30; ++i) {
    Real effort = 0;
    for (int s = 0; s < 10; ++s) {  // I (v' - v) = h [kp (target - q - h v') + kd (rate - v') + effort]
      v = (kInertia * v + kH * (kKp * (kTarget - q) + kKd * kRate + 0.3)) / (kInertia + kH * kKd + kH * kH * kKp);
      q += kH * v;
      effort += (kKp * (kTarget - q) + kKd * (kRate - v) + 0.3) / 10;
    }
    world.step(0.01);
    EXPECT_NEAR(world.state(robot).q[0], q, 1e-13);
    EXPECT_NEAR(world.state(robot).v[0], v, 1e-11);
    EXPECT_NEAR(world.drive_effort(robot)[0], effort, 1e-9);
  }
}

TEST(Drive, AVelocityDriveReachesItsSpeedAndAnEffortDrivePushesJustThat) {
  World world;
  const int robot = world.add_robot(kHinge, {.drives = {{.kp = 300, .kd = 5}}});
  world.command(robot, {{.kind = Kind::velocity, .velocity = 2}});
  for (int i = 0; i < 20; ++i) world.step(0.01);
  EXPECT_NEAR(world.state(robot).v[0], 2, 1e-10);
  world.command(robot, {{.kind = Kind::effort, .effort = 0.5}});
  world.step(0.01);
  EXPECT_NEAR(world.state(robot).v[0], 2 + 0.01 * 0.5 / kInertia, 1e-10);
}

TEST(Drive, TheEffortLimitBites) {
  constexpr Real kLimit = 0.6;
  World world;
  const Model limited = one_joint(JointType::revolute, Vec3::UnitZ(), kWheel, {.name = "joint", .effort = kLimit});
  const int robot = world.add_robot(limited, {.drives = {{.kp = 1e4, .kd = 5}}});
  world.command(robot, {{.kind = Kind::position, .position = -3}});
  world.step(0.01);
  EXPECT_NEAR(world.state(robot).v[0], -0.01 * kLimit / kInertia, 1e-12);
  EXPECT_EQ(world.saturation(robot), std::vector<int>{-1});
  EXPECT_NEAR(world.drive_effort(robot)[0], -kLimit, 1e-12);
  EXPECT_NEAR(world.response(robot, 1e-3)(0, 0), kH * kH / kInertia, 1e-15);  // a saturated drive does not hold
  world.command(robot, {{.kind = Kind::effort, .effort = 2 * kLimit}});
  world.step(0.01);
  EXPECT_NEAR(world.drive_effort(robot)[0], kLimit, 1e-12);
  world.command(robot, {{.kind = Kind::position, .position = world.state(robot).q[0]}});
  for (int i = 0; i < 300; ++i) world.step(0.01);
  EXPECT_EQ(world.saturation(robot), std::vector<int>{0});
}

namespace {
/// [J] of the links' weight.
Real potential(World& world, int robot, const VecX& q) {
  world.set_state(robot, {.q = q, .v = VecX::Zero(q.size())});
  Real sum = 0;
  for (int link = 0; link <= static_cast<int>(q.size()); ++link) {
    const Inertial& i = world.model(robot).links[static_cast<std::size_t>(link)].inertial;
    sum += i.mass * 9.81 * (world.link_pose(robot, link) * i.com).z();
  }
  return sum;
}
}  // namespace

TEST(Drive, GravityCompensationPushesTheSlopeOfThePotentialAndHoldsARobotWhereItIs) {
  RobotModel model = tree();
  model.joints[4].mimic = Mimic{.joint = 2, .multiplier = -0.7, .offset = 0.1};
  World world;
  const int robot = world.add_robot(std::make_shared<RobotModel>(model),
                                    {.drives = std::vector<DriveGains>(5, {.kp = 200, .kd = 10}), .compensate_gravity = true});
  VecX q = odd_numbers(5, 0.6);
  q[4] = 0.1 - 0.7 * q[2];
  constexpr Real kStep = 1e-5;
  for (int k = 0; k < 4; ++k) {
    const VecX u = VecX::Unit(5, k) + (k == 2 ? -0.7 : 0) * VecX::Unit(5, 4);
    const Real slope = (potential(world, robot, q + kStep * u) - potential(world, robot, q - kStep * u)) / (2 * kStep);
    world.set_state(robot, {.q = q, .v = VecX::Zero(5)});
    world.command(robot, hold(q));
    world.step(1e-3);
    EXPECT_NEAR(world.drive_effort(robot)[k], slope, 1e-7) << k;
  }
  for (int i = 0; i < 20; ++i) world.step(0.01);
  EXPECT_LT((world.state(robot).q - q).cwiseAbs().maxCoeff(), 1e-12);
}

TEST(Drive, GravityCompensationLeavesJointsWithoutGainsAndEffortsAlone) {
  for (const DriveGains& gains : {DriveGains{}, DriveGains{.kp = 200, .kd = 10}}) {
    World world;
    const int robot = world.add_robot(kTree, {.drives = std::vector<DriveGains>(5, gains), .compensate_gravity = true});
    if (gains.kp > 0) world.command(robot, std::vector<JointCommand>(5));
    world.step(1e-3);
    EXPECT_EQ(world.drive_effort(robot).norm(), 0);
    EXPECT_GT(world.state(robot).v.norm(), 1e-3);
  }
}

TEST(Drive, OneSaturatedJointDoesNotChangeTheLawOfTheOthers) {
  World world({.gravity = Vec3::Zero()});
  std::vector<DriveGains> gains = kStiff;
  gains[1].effort = 2;
  const int robot = world.add_robot(kTree, {.drives = gains});
  const RobotState s{Pose::Identity(), odd_numbers(5, 0.6), VecX::Zero(5)};
  world.set_state(robot, s);
  world.command(robot, hold(s.q + VecX::Constant(5, 0.05)));
  const MatX M = world.mass_matrix(robot);
  world.step(kH);
  EXPECT_EQ(world.saturation(robot), (std::vector<int>{0, 1, 0, 0, 0}));
  MatX K = M;  // from rest there are no Coriolis forces but those of the new velocity, of second order
  VecX impulse = VecX::Constant(5, kH * 2000 * 0.05);
  for (const int k : {0, 2, 3, 4}) K(k, k) += kH * 40 + kH * kH * 2000;
  impulse[1] = kH * 2;
  const VecX v = K.llt().solve(impulse);
  EXPECT_LT((world.state(robot).v - v).norm(), 1e-3 * v.norm());
}

TEST(Drive, AgainstAStopAStiffDrivePressesWithItsFullSpring) {
  constexpr Real kKp = 400, kKd = 20, kBeyond = 0.01;  // h kd is as large as the inertia: Bullet's bare mass would halve the force
  World world({.gravity = Vec3::Zero()});
  const Inertial slider{0.02, Vec3::Zero(), 1e-5 * Mat3::Identity()};
  RobotModel model = *one_joint(JointType::prismatic, Vec3::UnitX(), slider);
  model.links[1].collision = {box_shape({0.02, 0.02, 0.02})};
  const int finger = world.add_robot(std::make_shared<RobotModel>(model), {.drives = {{.kp = kKp, .kd = kKd}}});
  world.add_robot(box({0.02, 0.1, 0.1}, 1), {.X_WB = at({0.05, 0, 0})});
  world.command(finger, {{.kind = Kind::position, .position = 0.03 + kBeyond}});
  for (int i = 0; i < 100; ++i) world.step(0.01);
  EXPECT_NEAR(world.state(finger).q[0], 0.03, 1e-5);
  Vec3 force = Vec3::Zero();
  for (const Contact& c : world.contacts()) force += c.robot_a == finger ? c.force : Vec3(-c.force);
  const Real spring = kKp * (0.03 + kBeyond - world.state(finger).q[0]);
  EXPECT_NEAR(force.x(), -spring, 1e-3 * spring);
  EXPECT_NEAR(world.drive_effort(finger)[0], spring, 1e-3 * spring);
}

TEST(Drive, AgainstAStopALimitedDrivePressesWithItsLimit) {
  World world({.gravity = Vec3::Zero()});
  const Inertial slider{0.02, Vec3::Zero(), 1e-5 * Mat3::Identity()};
  const Model model = one_joint(JointType::prismatic, Vec3::UnitX(), slider, {.name = "joint", .upper = 0.03});
  const int finger = world.add_robot(model, {.drives = {{.kp = 400, .kd = 20, .effort = 1.5}}});
  world.command(finger, {{.kind = Kind::position, .position = 0.05}});
  for (int i = 0; i < 100; ++i) world.step(0.01);
  EXPECT_NEAR(world.drive_effort(finger)[0], 1.5, 1e-9);
  EXPECT_EQ(world.saturation(finger), std::vector<int>{1});
}

TEST(Drive, AStiffDriveSlidesOnDryFrictionWithItsTrueLag) {
  constexpr Real kKp = 2000, kKd = 50, kFriction = 0.8, kRate = 0.5;
  World world;
  const Model model = one_joint(JointType::revolute, Vec3::UnitZ(), kWheel, {.name = "joint", .friction = kFriction});
  const int robot = world.add_robot(model, {.drives = {{.kp = kKp, .kd = kKd}}});
  Real target = 0;
  for (int i = 0; i < 2000; ++i) {
    target += kRate * kH;
    world.command(robot, {{.kind = Kind::position, .position = target, .velocity = kRate}});
    world.step(kH);
  }
  EXPECT_NEAR(target - world.state(robot).q[0], kFriction / kKp, 1e-9);
}

TEST(Response, OverOneSubstepItIsTheInverseOfInertiaDampingAndStiffness) {
  World world;
  const int robot = world.add_robot(kTree, {.drives = kStiff});
  world.set_state(robot, odd_state(world, robot));
  world.command(robot, hold(VecX::Zero(5)));
  const MatX K = world.mass_matrix(robot) + (kH * 40 + kH * kH * 2000) * MatX::Identity(5, 5);
  EXPECT_TRUE(world.response(robot, kH).isApprox(kH * kH * MatX(K.inverse()), 1e-12));
}

TEST(Response, ItIsTheSlopeOfBulletsOwnSteps) {
  for (const bool fixed : {true, false}) {
    World world;
    const int robot = world.add_robot(kTree, {.fixed_base = fixed, .drives = kStiff});
    const RobotState s{at({0.2, -0.1, 0.5}, 0.8, {1, 3, -2}), odd_numbers(5, 0.6), VecX::Zero(world.dof(robot))};
    world.set_state(robot, s);
    world.command(robot, hold(s.q));
    const Snapshot start = world.save();
    const MatX S = world.response(robot, 0.01);
    EXPECT_EQ(S, S.transpose());
    EXPECT_EQ(S.llt().info(), Eigen::Success);
    for (int k = 0; k < world.dof(robot); ++k) {
      constexpr Real kForce = 1e-3;
      const auto moved_by = [&](Real force) {
        world.restore(start);
        world.step(0.01, {force * VecX::Unit(world.dof(robot), k)});
        return displacement(s, world.state(robot), fixed);
      };
      const VecX slope = (moved_by(kForce) - moved_by(-kForce)) / (2 * kForce);
      EXPECT_LT((S.col(k) - slope).norm(), 2e-3 * S.col(k).norm()) << "coordinate " << k;
    }
  }
}

TEST(Response, WithSaturatedAndMimickingJointsItIsTheSlopeOfBulletsOwnSteps) {
  RobotModel model = tree();
  model.joints[4].mimic = Mimic{3, -0.7, 0.2};
  World world({.gravity = Vec3::Zero()});
  std::vector<DriveGains> gains = kStiff;
  gains[1].effort = 0.5;
  const int robot = world.add_robot(std::make_shared<RobotModel>(model), {.drives = gains});
  const RobotState s{Pose::Identity(), odd_numbers(5, 0.6), VecX::Zero(5)};
  world.set_state(robot, s);
  VecX target = world.state(robot).q;
  target[1] += 0.5;  // far beyond what half a newton metre reaches
  world.command(robot, hold(target));
  world.step(kH);
  ASSERT_EQ(world.saturation(robot), (std::vector<int>{0, 1, 0, 0, 0}));
  const RobotState from = world.state(robot);
  const Snapshot start = world.save();
  const MatX S = world.response(robot, 0.01);
  EXPECT_EQ(world.motions(robot).cols(), 4);
  for (int k = 0; k < 5; ++k) {
    constexpr Real kForce = 1e-3;
    const auto moved_by = [&](Real force) {
      world.restore(start);
      world.step(0.01, {force * VecX::Unit(5, k)});
      return VecX(world.state(robot).q - from.q);
    };
    const VecX slope = (moved_by(kForce) - moved_by(-kForce)) / (2 * kForce);
    EXPECT_LT((S.col(k) - slope).norm(), 5e-3 * S.col(k).norm()) << "coordinate " << k;
  }
}
