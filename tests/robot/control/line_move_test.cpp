#include "robot/control/line_move.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "robot/control/motion_profile.hpp"
#include "robot/kinematics/forward_kinematics.hpp"
#include "tests/robot/kinematics/arms.hpp"
using namespace robot;
using testing::HasSubstr;
using testing::ThrowsMessage;

namespace {
Pose tool_at(const RobotModel& arm, const VecX& q) { return frame_pose(link_poses(arm, q), *arm.find_frame("tool")); }
VecX bent() { return (VecX(7) << 0.1, 0.5, 0.1, 1.2, 0, -0.6, 0).finished(); }
}  // namespace

TEST(LineMove, TheFrameStaysOnItsLineAndTurnsAboutOneAxisAsTheProfileSays) {
  const RobotModel arm = test::seven_joint_arm();
  const Pose X0 = tool_at(arm, bent());
  const Vec3 way(0.06, -0.08, 0.05), axis = Vec3(1, 1, -1).normalized();
  Pose X1 = X0;
  X1.translation() += way;
  X1.linear() = Eigen::AngleAxisd(0.4, axis) * X0.linear();
  const LineMove move = line_move(arm, {*arm.find_frame("tool"), X1}, bent());
  ASSERT_EQ(move.failure, "");
  EXPECT_EQ(move.fraction, 1);
  const Real turn = 15. / 8 * 0.4 / 0.5, shift = 15. / 8 * way.norm() / 0.1;  // [s] at peak speeds of 0.5 rad/s and 0.1 m/s
  EXPECT_NEAR(move.trajectory.end(), std::ceil(std::max(turn, shift) * 100) / 100, 1e-12);
  const std::vector<VecX> q = sample(move.trajectory);
  for (std::size_t i = 0; i < q.size(); ++i) {
    const Pose X = tool_at(arm, q[i]);
    const Real s = MotionProfile::at(static_cast<Real>(i) / static_cast<Real>(q.size() - 1)).value;
    EXPECT_LT((X.translation() - X0.translation() - s * way).norm(), 2e-6);
    EXPECT_LT((X.linear() - Eigen::AngleAxisd(s * 0.4, axis) * X0.linear()).norm(), 4e-6);
  }
}

TEST(LineMove, APoseThatTheArmCannotHoldEndsItAtOnceAndNamesTheError) {
  const RobotModel arm = test::planar_arm(0.3, 0.3);
  const Frame tip = *arm.find_frame("tip");
  const Eigen::Vector2d q0(0.2, 1.5);
  Pose X1 = frame_pose(link_poses(arm, q0), tip);  // two joints cannot move the tip without turning it
  X1.translation().y() += 0.1;
  const LineMove move = line_move(arm, {tip, X1}, q0);
  EXPECT_LT(move.fraction, 1e-3);
  EXPECT_THAT(move.failure, HasSubstr("no joint positions nearer than"));
}

TEST(LineMove, ItEndsAtALimitRatherThanJumpToAnotherSolution) {
  RobotModel arm = test::planar_arm(0.3, 0.3);
  arm.joints[0].lower = 0;
  const Frame tip = *arm.find_frame("tip");
  const Eigen::Vector2d q0(0.2, 1.5), beyond(-0.3, 1.5);
  const FrameTarget target{tip, frame_pose(link_poses(arm, beyond), tip), Vec3::Ones(), Vec3::Zero()};
  FrameTarget near = target;
  near.X_WT = frame_pose(link_poses(arm, Eigen::Vector2d(0.1, 1.5)), tip);
  EXPECT_NEAR(line_move(arm, near, q0, {.turning_speed = 0.01}).trajectory.end(), 15. / 8 * 2 * 0.6 * std::cos(0.75) * std::sin(0.05) / 0.1,
              0.01);                                   // turning takes no time
  EXPECT_TRUE(solve_ik(arm, {target}, q0).converged);  // with the elbow on its other side
  const LineMove move = line_move(arm, target, q0);
  EXPECT_NE(move.failure, "");
  EXPECT_GT(move.fraction, 0.2);
  for (const VecX& q : move.trajectory.knots) EXPECT_GT(q[1], 1);  // the elbow has stayed on its side
}

TEST(LineMove, ItEndsWhereTheTargetIsOutOfReach) {
  const RobotModel arm = test::seven_joint_arm();
  const Pose X0 = tool_at(arm, bent());
  Pose X1 = X0;
  X1.translation() += Vec3(2, 0, 0);
  const LineMove move = line_move(arm, {*arm.find_frame("tool"), X1}, bent(), {.speed = 1, .acceleration = 5});
  EXPECT_NE(move.failure, "");
  EXPECT_GT(move.fraction, 0);
  EXPECT_LT(move.fraction, 1);
  const Vec3 reached = tool_at(arm, move.trajectory.knots.back()).translation();
  EXPECT_NEAR(reached.x() - X0.translation().x(), 2 * move.fraction, 2e-6);
  EXPECT_LT((reached - Vec3(0, 0, 0.36)).norm(), 0.42 + 0.4 + 0.126);  // no farther from the shoulder than the stretched arm
}

TEST(LineMove, AJointThatWouldHaveToMoveTooFastEndsIt) {
  RobotModel arm = test::seven_joint_arm();
  for (Joint& joint : arm.joints) joint.velocity = 0.05;
  Pose X1 = tool_at(arm, bent());
  X1.translation() += Vec3(0.1, 0, 0);
  const LineMove move = line_move(arm, {*arm.find_frame("tool"), X1}, bent());
  EXPECT_THAT(move.failure, HasSubstr("(allowed: 0.05)"));
  for (std::size_t k = 1; k < move.trajectory.knots.size(); ++k)
    EXPECT_LE((move.trajectory.knots[k] - move.trajectory.knots[k - 1]).cwiseAbs().maxCoeff(), 0.05 * 0.01 * (1 + 1e-8));
}

TEST(LineMove, ToWhereTheFrameIsItTakesNoTime) {
  const RobotModel arm = test::seven_joint_arm();
  const LineMove move = line_move(arm, {*arm.find_frame("tool"), tool_at(arm, bent())}, bent());
  EXPECT_EQ(move.failure, "");
  EXPECT_EQ(move.trajectory.knots.back(), bent());
  EXPECT_LE(move.trajectory.end(), 0.01);  // one command at most, for round-off
}

TEST(LineMove, LimitsThatAreNotPositiveAreRefused) {
  const RobotModel arm = test::seven_joint_arm();
  EXPECT_THAT(
      [&] {
        line_move(arm, {*arm.find_frame("tool"), Pose::Identity()}, bent(), {.speed = 0});
      },
      ThrowsMessage<InputError>(HasSubstr("speed = 0 (allowed: > 0)")));
}
