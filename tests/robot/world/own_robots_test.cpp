// The project's robots on drives.
#include <gtest/gtest.h>

#include <numbers>

#include "robot/control/postures.hpp"
#include "robot/model/primitives.hpp"
#include "tests/robot/support/own_robots.hpp"
#include "tests/robot/world/driving.hpp"
using namespace robot;
using namespace robot::test;

namespace {
constexpr Real kMs = 1e-3;
using Model = std::shared_ptr<const RobotModel>;

Model own(const std::string& name) { return std::make_shared<RobotModel>(own_robot(name)); }
Model without_friction(RobotModel model) {
  for (Joint& joint : model.joints) joint.friction = 0;
  return std::make_shared<RobotModel>(std::move(model));
}
VecX arm_pose() {
  VecX q(7);
  q << 0.3, 0.9, -0.4, 1.1, 0.5, 0.7, -0.2;
  return q;
}
/// A robot with a fixed base, at rest at q and held there.
int held(World& world, const Model& model, const VecX& q, const Pose& X_WB = Pose::Identity()) {
  const int robot = world.add_robot(model, {.X_WB = X_WB, .drives = drives_of(*model)});
  world.set_state(robot, {X_WB, q, VecX::Zero(q.size())});
  world.command(robot, hold(q));
  return robot;
}
/// On its side, so that every joint carries weight.
const Pose kLyingBase(Eigen::AngleAxisd(1.1, Vec3(1, 2, 0).normalized()));
}  // namespace

TEST(OwnArm, ItsDrivesSagByTheWeightsTorqueOverTheirStiffness) {
  const Model arm = without_friction(own_robot("arm7"));
  World world;
  const int robot = held(world, arm, arm_pose(), kLyingBase);
  for (int i = 0; i < 200; ++i) world.step(0.01);
  const VecX torque = weight_torque(*arm, arm_pose(), kLyingBase.linear().transpose() * Vec3(0, 0, -9.81));
  for (int k = 0; k < 7; ++k) {
    const Real sag = world.state(robot).q[k] - arm_pose()[k], expected = torque[k] / arm_drive(k).kp;
    EXPECT_NEAR(sag, expected, 0.01 * torque.norm() / arm_drive(k).kp) << "joint " << k + 1;
    EXPECT_NEAR(world.drive_effort(robot)[k], -torque[k], 0.01 * torque.norm()) << "joint " << k + 1;
  }
  EXPECT_GT(std::abs(torque[1]), 20);  // the shoulder has something to carry
}

TEST(OwnArm, WithItsDryFrictionItRestsWithinTheBandThatFrictionHolds) {
  const Model arm = own("arm7");
  World world;
  const int robot = held(world, arm, arm_pose(), kLyingBase);
  for (int i = 0; i < 200; ++i) world.step(0.01);
  EXPECT_LT(world.state(robot).v.norm(), 1e-6);
  const VecX q = world.state(robot).q, torque = weight_torque(*arm, q, kLyingBase.linear().transpose() * Vec3(0, 0, -9.81));
  for (int k = 0; k < 7; ++k)
    EXPECT_LE(std::abs(arm_drive(k).kp * (q[k] - arm_pose()[k]) - torque[k]), arm->joints[static_cast<std::size_t>(k)].friction * 1.001)
        << "joint " << k + 1;
}

TEST(OwnArm, ItFollowsAQuinticTrajectoryWithinWhatTheMotionsTorqueStretchesItsDrives) {
  const Model arm = own("arm7");
  std::vector<std::string> names;
  for (const Joint& joint : arm->joints) names.push_back(joint.name);
  const VecX goal = (VecX(7) << -0.2, 0.2, 0.5, 0.3, -0.4, -0.5, 0.6).finished();
  const JointTrajectory path = trajectory_within(names, {arm_pose(), goal}, motion_limits(*arm, names, 0.8, 8));
  World world;
  const int robot = held(world, arm, arm_pose());
  WorstTorque worst(arm);
  VecX error = VecX::Zero(7);
  for (Real t = kMs; t < path.end() + 0.2; t += kMs) {
    const JointTrajectory::Point point = path.at(t);
    worst.add(point.q, point.v, point.a);
    std::vector<JointCommand> commands(7);
    command(commands, indices(*arm, names), {point.q, path.at(t - kMs / 2).v, {}});
    world.command(robot, commands);
    world.step(kMs);
    error = error.cwiseMax((world.state(robot).q - point.q).cwiseAbs());
  }
  EXPECT_GT(worst.torque()[1], 30);
  for (int k = 0; k < 7; ++k) {
    EXPECT_LT(error[k], 1.1 * worst.torque()[k] / arm_drive(k).kp) << "joint " << k + 1;
    EXPECT_LT(std::abs(world.state(robot).q[k] - goal[k]), 0.01) << "joint " << k + 1;
  }
}

TEST(OwnArm, ItsEffortLimitsBiteWhenTheFlangeIsLoaded) {
  const Model arm = own("arm7");
  VecX stretched = VecX::Zero(7);
  stretched[1] = std::numbers::pi / 2;  // forward, horizontally
  World world;
  const int robot = held(world, arm, stretched);
  const Frame flange = *arm->find_frame("arm_flange");
  const auto load = [&](Real newton) -> VecX {
    const std::vector<Pose> X = link_poses(*arm, world.state(robot).q);
    return jacobian(*arm, X, flange.link, frame_pose(X, flange).translation()).topRows<3>().transpose() * Vec3(0, 0, -newton);
  };
  const Real limit = arm->joints[1].effort, weight = weight_torque(*arm, stretched)[1], reach = 0.84;  // [N m], [m] shoulder to flange
  const Real most = (limit - std::abs(weight)) / reach;                                                // [N] that the shoulder holds there
  ASSERT_GT(most, 30);
  for (int i = 0; i < 100; ++i) world.step(0.01, {load(0.9 * most)});
  EXPECT_EQ(world.saturation(robot), std::vector<int>(7, 0));
  EXPECT_NEAR(world.state(robot).q[1], stretched[1], 0.02);
  for (int i = 0; i < 30; ++i) world.step(0.01, {load(1.3 * most)});
  EXPECT_EQ(world.saturation(robot)[1], -1);
  EXPECT_NEAR(world.drive_effort(robot)[1], -limit, 1e-9);
  EXPECT_GT(world.state(robot).q[1], stretched[1] + 0.1);  // it gives way, downwards
}

namespace {
VecX posture(const RobotModel& hand, const HandPostures& postures, const std::string& side, const std::string& name) {
  return all_joints(hand, postures.joints_of(side + "_"), postures.angles(hand, side + "_", name));
}
}  // namespace

TEST(OwnHand, ItsLinksDoNotTouchInAnyPosture) {
  const HandPostures postures = read_postures(TAPE_SOURCE_DIR "/data/robots/hand_postures.yaml");
  for (const std::string side : {"left", "right"})
    for (const auto& [name, values] : postures.postures) {
      const Model hand = own("hand20_" + side);
      World world;
      held(world, hand, posture(*hand, postures, side, name));
      world.step(kMs);
      EXPECT_TRUE(world.contacts().empty()) << side << " " << name;
    }
}

TEST(OwnHand, ItClosesFromOpenToEachPostureAndStaysThere) {
  const HandPostures postures = read_postures(TAPE_SOURCE_DIR "/data/robots/hand_postures.yaml");
  for (const std::string side : {"left", "right"})
    for (const auto& [name, values] : postures.postures) {
      const Model hand = own("hand20_" + side);
      const VecX open = posture(*hand, postures, side, "open"), target = posture(*hand, postures, side, name);
      const JointTrajectory path = postures.move(*hand, side + "_", postures.angles(*hand, side + "_", "open"), name, 0.6);
      World world;
      const int robot = held(world, hand, open);
      std::vector<JointCommand> commands(20);
      for (Real t = 5 * kMs; t < path.end() + 0.2; t += 5 * kMs) {
        command(commands, indices(*hand, path.joints), path.at(t));
        world.command(robot, commands);
        world.step(5 * kMs);
      }
      const VecX weight = weight_torque(*hand, target);
      for (int k = 0; k < 20; ++k) {
        const Real band = (std::abs(weight[k]) + hand->joints[static_cast<std::size_t>(k)].friction) / kFingerDrive.kp;
        EXPECT_LT(std::abs(world.state(robot).q[k] - target[k]), 1.02 * band)
            << side << " " << name << " " << hand->joints[static_cast<std::size_t>(k)].name;
      }
      EXPECT_EQ(world.saturation(robot), std::vector<int>(20, 0)) << side << " " << name;
      EXPECT_TRUE(world.contacts().empty()) << side << " " << name;
    }
}

namespace {
/// The station stands on the ground with its own weight and moves both arms.
RobotState moved_station(Real& lowest, Real& most_tilt) {
  const Model station = own("station");
  RobotModel ground{.name = "ground"};
  ground.links = {{.name = "ground", .collision = {box_shape({4, 4, 0.1}, Pose(Eigen::Translation3d(0, 0, -0.05)))}}};
  World world({.substep = 2e-3});
  world.add_robot(std::make_shared<RobotModel>(ground));
  const int robot = world.add_robot(station, {.fixed_base = false, .drives = drives_of(*station)});
  VecX start = VecX::Zero(54), goal = start;
  for (const std::string side : {"left", "right"}) {
    start[station->find_joint(side + "_arm_joint2")] = 1.2;
    start[station->find_joint(side + "_arm_joint4")] = 0.4;
    goal[station->find_joint(side + "_arm_joint1")] = 0.5;
    goal[station->find_joint(side + "_arm_joint2")] = 0.8;
    goal[station->find_joint(side + "_arm_joint4")] = 1.2;
  }
  std::vector<std::string> names;
  for (const Joint& joint : station->joints) names.push_back(joint.name);
  const JointTrajectory path = trajectory_at(names, {start, goal}, {0, 0.8}, motion_limits(*station, names, 1, 50));
  world.set_state(robot, {Pose::Identity(), start, VecX::Zero(60)});
  std::vector<JointCommand> commands(54);
  for (Real t = 0.01; t < 0.9; t += 0.01) {
    command(commands, indices(*station, names), path.at(t));
    world.command(robot, commands);
    world.step(0.01);
    const Pose X = world.state(robot).X_WB;
    lowest = std::min(lowest, X.translation().z());
    most_tilt = std::max(most_tilt, std::acos(std::min(1., X.linear()(2, 2))));
  }
  return world.state(robot);
}
}  // namespace

TEST(OwnStation, ItStandsOnTheGroundWhileItMovesBothArmsAndDoesTheSameAgain) {
  Real lowest = 0, most_tilt = 0;
  const RobotState once = moved_station(lowest, most_tilt), again = moved_station(lowest, most_tilt);
  EXPECT_GT(lowest, -0.0005);
  EXPECT_LT(most_tilt, 0.002);
  const Model station = own("station");
  for (const std::string side : {"left", "right"})
    for (const auto& [joint, angle] : {std::pair("1", 0.5), {"2", 0.8}, {"4", 1.2}})
      EXPECT_NEAR(once.q[station->find_joint(side + "_arm_joint" + joint)], angle, 0.02) << side << " joint " << joint;
  EXPECT_EQ(once.X_WB.matrix(), again.X_WB.matrix());
  EXPECT_EQ(once.q, again.q);
  EXPECT_EQ(once.v, again.v);
}
