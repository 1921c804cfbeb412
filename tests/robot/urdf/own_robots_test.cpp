#include <gmock/gmock.h>

#include <cmath>

#include "robot/kinematics/forward_kinematics.hpp"
#include "robot/model/inertia.hpp"
#include "robot/urdf/describe.hpp"
#include "tests/robot/support/own_robots.hpp"
using namespace robot;
using test::own_robot;
using testing::IsEmpty;

namespace {
/// In the plane y = 0.
const Vec3 kMirror(1, -1, 1);

/// Bend of each joint, the same for joints that correspond.
VecX some_joints(int count, int period) {
  VecX q(count);
  for (int j = 0; j < count; ++j) q[j] = 0.2 + 0.05 * (j % period);
  return q;
}

/// Link r of one robot is the mirror image of link l of another: mass, com and inertia, where they stand in the base's frame.
void expect_mirrored(const Link& l, const Pose& X_l, const Link& r, const Pose& X_r) {
  const Mat3 M = kMirror.asDiagonal();
  EXPECT_EQ(l.inertial.mass, r.inertial.mass) << l.name;
  EXPECT_LT((M * (X_l * l.inertial.com) - X_r * r.inertial.com).norm(), 2e-6) << l.name;  // the files keep six digits
  const Mat3 Il = moved(X_l, l.inertial).inertia, Ir = moved(X_r, r.inertial).inertia;
  EXPECT_LT((M * Il * M - Ir).norm(), 1e-4 * Il.norm()) << l.name;
  EXPECT_EQ(l.collision.size(), r.collision.size()) << l.name;
}
}  // namespace

TEST(OwnRobots, LoadWithoutAssumptionsAndHaveTheJointsThatTheyPromise) {
  for (const auto& [name, joints] : {std::pair("arm7", 7), {"hand20_left", 20}, {"hand20_right", 20}, {"station", 54}}) {
    const RobotModel robot = own_robot(name);
    EXPECT_EQ(robot.joints.size(), static_cast<std::size_t>(joints)) << name;
    EXPECT_EQ(robot.name, name);
    EXPECT_THAT(robot.notes, IsEmpty()) << name;
    for (const Joint& j : robot.joints) {
      EXPECT_EQ(j.type, JointType::revolute);
      EXPECT_TRUE(std::isfinite(j.effort) && std::isfinite(j.velocity) && j.lower < j.upper) << j.name;
      EXPECT_TRUE(j.damping > 0 && j.friction > 0 && j.friction < 0.05 * j.effort) << j.name;
    }
    for (const Link& l : robot.links) EXPECT_GT(principal_moments(l.inertial.inertia).minCoeff(), 0) << l.name;
  }
}

TEST(OwnRobots, TheArmHasTheMassAndReachOfItsReadme) {
  const RobotModel arm = own_robot("arm7");
  EXPECT_NEAR(total_mass(arm), 18.6, 1e-12);
  const auto X = link_poses(arm, VecX::Zero(7));
  const Vec3 shoulder = X[2].translation(), flange = X[7] * arm.find_frame("arm_flange")->X_LF.translation();
  EXPECT_NEAR((flange - shoulder).norm(), 0.84, 1e-12);
}

TEST(OwnRobots, TheHandsHaveTheMassOfTheirReadmeAndAreMirrored) {
  const RobotModel left = own_robot("hand20_left"), right = own_robot("hand20_right");
  EXPECT_NEAR(total_mass(right), 0.5196, 1e-12);
  const VecX q = some_joints(20, 20);
  const auto Xl = link_poses(left, q), Xr = link_poses(right, q);
  for (std::size_t l = 0; l < left.links.size(); ++l) expect_mirrored(left.links[l], Xl[l], right.links[l], Xr[l]);
  EXPECT_LT(Xr[4].translation().y() * Xl[4].translation().y(), 0);  // the thumbs are on opposite sides
}

TEST(OwnRobots, TheSidesOfTheStationAreMirroredAndMadeOfTheArmAndTheHands) {
  const RobotModel station = own_robot("station"), arm = own_robot("arm7"), hand = own_robot("hand20_left");
  const auto X = link_poses(station, some_joints(54, 27));
  for (std::size_t l = 1; l <= 27; ++l) {
    EXPECT_EQ(station.links[l].name.substr(5), station.links[l + 27].name.substr(6));  // behind "left_" and "right_"
    expect_mirrored(station.links[l], X[l], station.links[l + 27], X[l + 27]);
  }
  EXPECT_EQ(station.joints[0].name, "left_arm_joint1");
  EXPECT_EQ(station.joints[7].name, "left_finger1_joint1");
  EXPECT_EQ(station.joints[27].name, "right_arm_joint1");
  for (std::size_t j = 0; j < 7; ++j) EXPECT_EQ(station.joints[j].effort, arm.joints[j].effort);
  for (std::size_t j = 0; j < 20; ++j) EXPECT_EQ(station.joints[7 + j].effort, hand.joints[j].effort);
  EXPECT_NEAR(total_mass(station), 62 + 2 * (total_mass(arm) + total_mass(hand)), 1e-9);
}

TEST(OwnRobots, TheSrdfFilesNameNeighboursAndPalmsAndNothingUnknown) {
  EXPECT_EQ(own_robot("arm7").may_overlap.size(), 7u);
  EXPECT_EQ(own_robot("hand20_left").may_overlap.size(), 20u + 5u);  // neighbours; palm and the link behind each knuckle
  EXPECT_EQ(own_robot("station").may_overlap.size(), 54u + 2 * 5u);
}

TEST(OwnRobots, TheShoulderHoldsTheStretchedArmWithItsHand) {
  const RobotModel station = own_robot("station");
  const auto X = link_poses(station, VecX::Zero(54));  // stretched out to the sides
  Real moment = 0;
  for (std::size_t l = 2; l <= 27; ++l)
    moment += 9.81 * station.links[l].inertial.mass * (X[l] * station.links[l].inertial.com - X[2].translation()).y();
  EXPECT_GT(moment, 30);
  EXPECT_LT(moment, 0.7 * station.joints[1].effort);
}
