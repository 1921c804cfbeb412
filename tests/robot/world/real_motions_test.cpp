// Motions that were recorded on real robots, on models of them and on the project's own. Skipped where the data is absent.
#include <gtest/gtest.h>

#include <numbers>

#include "robot/control/trajectory_file.hpp"
#include "robot/control/vendor_recording.hpp"
#include "tests/robot/support/folder.hpp"
#include "tests/robot/support/own_robots.hpp"
#include "tests/robot/support/real_data.hpp"
#include "tests/robot/world/driving.hpp"
using namespace robot;
using namespace robot::test;

namespace {
constexpr Real kMs = 1e-3;
const std::vector<std::string> kMarvin = {"Joint1_L", "Joint2_L", "Joint3_L", "Joint4_L", "Joint5_L", "Joint6_L", "Joint7_L"};

fs::path marvin_file(const std::string& name) { return real_data() / "marvin_m6_ccs" / "recordings" / name; }
/// The vendor has no SRDF file. Its links are hollow where the next but one turns: their convex hulls overlap.
std::shared_ptr<const RobotModel> marvin_model() {
  const TextFile srdf(
      "<robot name=\"marvin\">"
      "<disable_collisions link1=\"Link3_L\" link2=\"Link5_L\"/>"
      "<disable_collisions link1=\"Link5_L\" link2=\"Link7_L\"/></robot>");
  return std::make_shared<RobotModel>(read_urdf(marvin_arm(), {.srdf = srdf}));
}
fs::path teleoperation() { return real_data() / "g1_inspire_lerobot" / "csv_converted" / "episode_000000.csv"; }

/// The mean of a path over +-width [s] about t, and its exact derivatives: smooths the recording's noise.
JointTrajectory::Point smooth(const JointTrajectory& path, Real t, Real width) {
  constexpr int kSamples = 40;
  const JointTrajectory::Point before = path.at(t - width), after = path.at(t + width);
  VecX mean = (before.q + after.q) / (2 * kSamples);
  for (int i = 1; i < kSamples; ++i) mean += path.at(t + width * (2. * i / kSamples - 1)).q / kSamples;
  return {mean, (after.q - before.q) / (2 * width), (after.v - before.v) / (2 * width)};
}

/// Columns of one arm of the G1 that drive one of the station's, so that upper arm and forearm point where the G1's do. Their zeros: the
/// G1's upper arm hangs and its forearm points forward, the station's arm is stretched out to the side; the right arms are mirrored. The
/// last joint of the G1's wrist yaws, the station's rolls: it takes the same angle.
std::vector<DrivenByColumn> g1_arm(const std::string& kind, bool left) {
  constexpr Real kRight = std::numbers::pi / 2;
  const Real side = left ? 1 : -1;
  const std::string arm = left ? "left_arm_joint" : "right_arm_joint", column = kind + (left ? ".kLeft" : ".kRight");
  return {{arm + "1", column + "ShoulderPitch", 1, kRight},
          {arm + "2", column + "ShoulderRoll", -side, kRight},
          {arm + "3", column + "ShoulderYaw", -side, -kRight},
          {arm + "4", column + "Elbow", -1, kRight},
          {arm + "5", column + "WristRoll", side, 0},
          {arm + "6", column + "WristPitch", -1, 0},
          {arm + "7", column + "WristYaw", side, 0}};
}
std::vector<DrivenByColumn> g1_arms(const std::string& kind) {
  std::vector<DrivenByColumn> all = g1_arm(kind, true);
  for (const DrivenByColumn& joint : g1_arm(kind, false)) all.push_back(joint);
  return all;
}
}  // namespace

TEST(RealMotions, RecordingsOfTheMarvinArmAreWithinItsLimitsAndSpeeds) {
  if (!fs::exists(marvin_file("aa.txt"))) GTEST_SKIP() << "needs " << marvin_file("aa.txt");
  const RobotModel arm = read_urdf(marvin_arm());
  for (const auto& [name, travel] : {std::pair("aa.txt", 90.), {"aaa.txt", 13.04}}) {  // [deg] of the third joint, from the file
    const JointTrajectory path = read_vendor_recording(marvin_file(name), arm, kMarvin, VendorColumns::recorded, {.slack = 0});
    EXPECT_EQ(path.knots.size(), 1000u);
    EXPECT_NEAR(path.end(), 0.999, 1e-12);
    EXPECT_NEAR((path.knots.back() - path.knots.front())[2] * 180 / std::numbers::pi, travel, 0.01);
    for (Real t = 0.01; t < path.end() - 0.01; t += kMs)
      for (int j = 0; j < 7; ++j)
        EXPECT_LT(std::abs(smooth(path, t, 0.01).v[j]), 1.02 * arm.joints[static_cast<std::size_t>(j)].velocity)
            << name << " joint " << j + 1;
  }
}

TEST(RealMotions, CommandFilesOfTheMarvinArmAreWithinItsLimits) {
  if (!fs::exists(marvin_file("PLN_MOVL_KEEPJ.txt"))) GTEST_SKIP() << "needs " << marvin_file("PLN_MOVL_KEEPJ.txt");
  const RobotModel arm = read_urdf(marvin_arm());
  for (const auto& [name, rows] : {std::pair("LoadIdenTraj_MarvinCCS_Left.fmv", 9571u), {"PLN_MOVL_KEEPJ.txt", 2107u}}) {
    const JointTrajectory path = read_vendor_recording(marvin_file(name), arm, kMarvin, VendorColumns::command);
    EXPECT_EQ(path.knots.size(), rows);
    EXPECT_NEAR(path.end(), 1e-3 * (rows - 1), 1e-9);
  }
}

TEST(RealMotions, TheMarvinArmsDrivesFollowItsRecordingsWithinWhatTheMotionsTorqueStretchesThem) {
  if (!fs::exists(marvin_file("aa.txt"))) GTEST_SKIP() << "needs " << marvin_file("aa.txt");
  const auto arm = marvin_model();
  std::vector<DriveGains> drives;
  for (int k = 0; k < 7; ++k) drives.push_back(arm_drive(k));
  for (const char* name : {"aa.txt", "aaa.txt"}) {
    const JointTrajectory path = read_vendor_recording(marvin_file(name), *arm, kMarvin, VendorColumns::recorded);
    WorstTorque worst(arm);
    World world;
    const int robot = world.add_robot(arm, {.drives = drives});
    world.set_state(robot, {Pose::Identity(), path.at(0).q, VecX::Zero(7)});
    std::vector<JointCommand> commands(7);
    VecX error = VecX::Zero(7);
    for (Real t = kMs; t < path.end(); t += kMs) {
      const JointTrajectory::Point motion = smooth(path, t, 0.01);
      worst.add(motion.q, motion.v, motion.a);
      command(commands, indices(*arm, kMarvin), {motion.q, smooth(path, t - kMs / 2, 0.01).v, {}});
      world.command(robot, commands);
      world.step(kMs);
      error = error.cwiseMax((world.state(robot).q - motion.q).cwiseAbs());
    }
    for (int k = 0; k < 7; ++k)
      EXPECT_LT(error[k], 1.1 * worst.torque()[k] / drives[static_cast<std::size_t>(k)].kp + 1e-5) << name << " joint " << k + 1;
  }
}

TEST(RealMotions, TeleoperationOfAG1PointsTheStationsArmsWhereItsOwnPointed) {
  if (!fs::exists(teleoperation())) GTEST_SKIP() << "needs " << teleoperation();
  constexpr Real kRounded = 1e-5;  // the station's file says 1.5708 where it means pi / 2
  const RobotModel station = own_robot("station");
  for (const std::string kind : {"state", "action"}) {
    const JointTrajectory path = read_table(teleoperation(), station, "timestamp", g1_arms(kind), {.slack = 0});
    EXPECT_EQ(path.knots.size(), 479u);
    EXPECT_NEAR(path.end(), 478 / 30., 1e-4);
    for (const bool left : {true, false}) {
      std::vector<DrivenByColumn> own;  // the G1's angles, as they are
      for (const DrivenByColumn& joint : g1_arm(kind, left)) own.push_back({joint.joint, joint.column});
      const JointTrajectory g1 = read_table(teleoperation(), station, "timestamp", own, {.slack = 9});
      const std::string arm = left ? "left_arm_" : "right_arm_";
      for (std::size_t row = 0; row < g1.knots.size(); row += 50) {
        const VecX& a = g1.knots[row];  // shoulder pitch, roll, yaw, elbow
        const Mat3 upper =
            (Eigen::AngleAxisd(a[0], Vec3::UnitY()) * Eigen::AngleAxisd(a[1], Vec3::UnitX()) * Eigen::AngleAxisd(a[2], Vec3::UnitZ()))
                .toRotationMatrix();
        const Vec3 forearm = upper * Eigen::AngleAxisd(a[3], Vec3::UnitY()).toRotationMatrix().col(0);
        const std::vector<Pose> X = link_poses(station, all_joints(station, path.joints, path.knots[row]));
        const auto along = [&](const char* joint) -> Vec3 {
          return X[static_cast<std::size_t>(station.find_joint(arm + joint)) + 1].linear().col(2);
        };
        EXPECT_LT((along("joint3") + upper.col(2)).norm(), kRounded) << arm << row;  // the G1's z points up its hanging arm
        EXPECT_LT((along("joint5") - forearm).norm(), kRounded) << arm << row;
      }
    }
  }
}

TEST(RealMotions, TheStationsDrivesFollowTheTeleoperationWithinWhatTheMotionsTorqueStretchesThem) {
  if (!fs::exists(teleoperation())) GTEST_SKIP() << "needs " << teleoperation();
  const auto station = std::make_shared<RobotModel>(own_robot("station"));
  const JointTrajectory path = read_table(teleoperation(), *station, "timestamp", g1_arms("action"));
  const std::vector<int> joints = indices(*station, path.joints);
  const std::vector<DriveGains> drives = drives_of(*station);
  constexpr Real kStart = 6, kTime = 1.5, kWidth = 1 / 30.;  // [s]
  WorstTorque worst(station);
  World world({.substep = 2e-3});
  const int robot = world.add_robot(station, {.drives = drives});
  const auto all = [&](const VecX& q) { return all_joints(*station, path.joints, q); };
  const JointTrajectory::Point first = smooth(path, kStart, kWidth);
  world.set_state(robot, {Pose::Identity(), all(first.q), all(first.v)});
  std::vector<JointCommand> commands = hold(VecX::Zero(54));
  VecX error = VecX::Zero(54);
  for (Real t = kStart + 2 * kMs; t < kStart + kTime; t += 2 * kMs) {
    const JointTrajectory::Point motion = smooth(path, t, kWidth);
    worst.add(all(motion.q), all(motion.v), all(motion.a));
    command(commands, joints, {motion.q, smooth(path, t - kMs, kWidth).v, {}});
    world.command(robot, commands);
    world.step(2 * kMs);
    error = error.cwiseMax((world.state(robot).q - all(motion.q)).cwiseAbs());
  }
  EXPECT_TRUE(world.contacts().empty());
  for (const int k : joints) {
    const std::string& name = station->joints[static_cast<std::size_t>(k)].name;
    EXPECT_LT(error[k], 1.1 * worst.torque()[k] / drives[static_cast<std::size_t>(k)].kp) << name;
    EXPECT_LT(error[k], 0.03) << name;  // [rad]
  }
}
