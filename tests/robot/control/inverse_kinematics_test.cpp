#include "robot/control/inverse_kinematics.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "robot/kinematics/forward_kinematics.hpp"
#include "tests/robot/kinematics/arms.hpp"
using namespace robot;
using testing::HasSubstr;
using testing::ThrowsMessage;

namespace {
VecX random_positions(const RobotModel& model, std::mt19937_64& random) {
  VecX q(model.joints.size());
  for (Eigen::Index k = 0; k < q.size(); ++k)
    q[k] = std::uniform_real_distribution<Real>(model.joints[k].lower, model.joints[k].upper)(random);
  return q;
}
bool within_limits(const RobotModel& model, const VecX& q) {
  for (Eigen::Index k = 0; k < q.size(); ++k)
    if (q[k] < model.joints[k].lower || q[k] > model.joints[k].upper) return false;
  return true;
}
Pose tip(const RobotModel& model, const VecX& q, const char* frame = "tip") {
  return frame_pose(link_poses(model, q), *model.find_frame(frame));
}
Real angle_between(const Pose& a, const Pose& b) { return std::fabs(Eigen::AngleAxisd(a.linear().transpose() * b.linear()).angle()); }
FrameTarget point(const RobotModel& model, const Vec3& p) {
  return {*model.find_frame("tip"), Pose(Eigen::Translation3d(p)), Vec3::Ones(), Vec3::Zero()};
}
}  // namespace

TEST(InverseKinematics, ReachesAtLeast99In100RandomPosesOfASevenJointArmWithinItsLimits) {
  RobotModel arm = test::seven_joint_arm();
  arm.links.push_back({.name = "finger"});
  arm.joints.push_back({.name = "finger", .parent = 7, .lower = -1, .upper = 1});
  const Frame tool = *arm.find_frame("tool");
  std::mt19937_64 random(20240501);
  int reached = 0, at_once = 0;
  long iterations = 0;
  for (int i = 0; i < 1000; ++i) {
    const Pose X_WT = tip(arm, random_positions(arm, random), "tool");
    const VecX q_start = random_positions(arm, random);
    const IkResult found = solve_ik(arm, {{tool, X_WT}}, q_start);
    const Pose X_WF = tip(arm, found.q, "tool");
    const Real position_error = (X_WF.translation() - X_WT.translation()).norm(), rotation_error = angle_between(X_WF, X_WT);
    EXPECT_NEAR(found.position_error, position_error, 1e-12);
    EXPECT_NEAR(found.rotation_error, rotation_error, 1e-9);
    EXPECT_TRUE(within_limits(arm, found.q));
    EXPECT_EQ(found.q[7], q_start[7]);  // carries no target, and restarts leave it alone too
    at_once += solve_ik(arm, {{tool, X_WT}}, q_start, {.restarts = 0}).converged;
    EXPECT_EQ(found.converged, found.position_error <= 1e-6 && found.rotation_error <= 1e-6);
    reached += position_error < 1e-6 && rotation_error < 1e-6;
    iterations += found.iterations;
  }
  RecordProperty("reached_of_1000", reached);
  RecordProperty("reached_without_restarts", at_once);
  RecordProperty("mean_iterations", static_cast<int>(iterations / 1000));
  EXPECT_GE(reached, 990);
  EXPECT_LT(at_once, reached);  // there are targets that need a restart
}

TEST(InverseKinematics, BothElbowsOfAPlanarArmAreFoundFromTheirSide) {
  const RobotModel arm = test::planar_arm(0.3, 0.2);
  const Real elbow = std::acos((0.4 * 0.4 - 0.3 * 0.3 - 0.2 * 0.2) / (2 * 0.3 * 0.2));  // law of cosines at a distance of 0.4 m
  for (int side : {-1, 1}) {
    const IkResult found = solve_ik(arm, {point(arm, {0.4, 0, 0})}, Eigen::Vector2d(0, side * 0.5), {.position_tol = 1e-12});
    ASSERT_TRUE(found.converged);
    EXPECT_NEAR(found.q[1], side * elbow, 1e-10);
  }
}

TEST(InverseKinematics, BeyondReachTheErrorIsTheDistanceAndThereIsNoClaimOfSuccess) {
  const RobotModel arm = test::planar_arm(0.3, 0.2);
  const IkResult far = solve_ik(arm, {point(arm, {0.6, 0.8, 0})}, Eigen::Vector2d(0.2, 0.4));
  EXPECT_FALSE(far.converged);
  EXPECT_NEAR(far.position_error, 1 - 0.5, 1e-9);  // stretched out towards it
  const IkResult near = solve_ik(arm, {point(arm, {0.03, 0.04, 0})}, Eigen::Vector2d(0.2, 0.4));
  EXPECT_FALSE(near.converged);
  EXPECT_NEAR(near.position_error, 0.1 - 0.05, 1e-9);  // folded up: no point is nearer to the base than 0.3 - 0.2
  const IkResult above = solve_ik(arm, {point(arm, {0.1, 0.2, 0.07})}, Eigen::Vector2d(0.2, 0.4));
  EXPECT_NEAR(above.position_error, 0.07, 1e-9);  // it stays in its plane
}

TEST(InverseKinematics, AJointAtItsLimitLeavesTheOthersToComeAsNearAsTheyCan) {
  RobotModel arm = test::planar_arm(0.3, 0.2);
  arm.joints[0].lower = -0.2, arm.joints[0].upper = 0.3;
  const Vec3 target(0, 0.5, 0);
  const IkResult found = solve_ik(arm, {point(arm, target)}, Eigen::Vector2d(0, 0.1));
  const Vec3 elbow(0.3 * std::cos(0.3), 0.3 * std::sin(0.3), 0);  // the shoulder is at its limit, the lower link points to the target
  EXPECT_FALSE(found.converged);
  EXPECT_EQ(found.q[0], 0.3);
  EXPECT_NEAR(found.position_error, (target - elbow).norm() - 0.2, 1e-9);
}

TEST(InverseKinematics, AJointAtItsLimitLeavesTheWholeStepToTheOthers) {
  RobotModel slides;
  slides.links = {{.name = "base"}, {.name = "a"}, {.name = "b"}};
  slides.joints = {{.name = "first", .type = JointType::prismatic, .upper = 0},
                   {.name = "second", .type = JointType::prismatic, .parent = 1}};
  slides.frames = {{"tip", 2, Pose::Identity()}};
  // Both slide along x. The step of both together would be cut in half at every iteration, (1/2)^4 of the way would be left.
  const IkResult found = solve_ik(slides, {point(slides, {0.3, 0, 0})}, VecX::Zero(2), {.max_iterations = 4, .restarts = 0});
  EXPECT_TRUE(found.converged);
  EXPECT_EQ(found.q[0], 0);
}

TEST(InverseKinematics, OfARotationThatCannotBeReachedTheLeastWeightedErrorIsFound) {
  RobotModel hinge;
  hinge.links = {{.name = "base"}, {.name = "a"}};
  hinge.joints = {{.name = "hinge", .axis = Vec3(1, 2, 3).normalized()}};
  hinge.frames = {{"tip", 1, Pose::Identity()}};
  FrameTarget target{*hinge.find_frame("tip"), Pose(Eigen::AngleAxisd(1.9, Vec3(3, -1, 1).normalized())), Vec3::Zero(), Vec3(1, 0.5, 2)};
  const auto cost = [&](Real q) {
    const Eigen::AngleAxisd turn(target.X_WT.linear().transpose() * tip(hinge, VecX::Constant(1, q)).linear());
    return (target.rotation_weight.asDiagonal() * (turn.angle() * turn.axis())).norm();
  };
  Real best = 0;
  for (int i = -31400; i <= 31400; ++i)
    if (cost(1e-4 * i) < cost(best)) best = 1e-4 * i;
  const IkResult found = solve_ik(hinge, {target}, VecX::Constant(1, best + 0.3));
  EXPECT_FALSE(found.converged);
  EXPECT_NEAR(found.q[0], best, 2e-4);
}

TEST(InverseKinematics, AnAxisWithoutWeightIsFree) {
  const RobotModel arm = test::planar_arm(0.3, 0.2);
  FrameTarget line = point(arm, {0.35, 5, 0});
  line.position_weight = {1, 0, 1};
  const IkResult on_line = solve_ik(arm, {line}, Eigen::Vector2d(0.2, 0.4));
  EXPECT_TRUE(on_line.converged);
  EXPECT_NEAR(tip(arm, on_line.q).translation().x(), 0.35, 1e-6);

  const RobotModel seven = test::seven_joint_arm();
  FrameTarget down{*seven.find_frame("tool"),
                   Pose(Eigen::Translation3d(0.5, 0.1, 0.2) * Eigen::AngleAxisd(std::numbers::pi, Vec3::UnitX()))};
  down.rotation_weight = {1, 1, 0};
  const IkResult found = solve_ik(seven, {down}, VecX::Constant(7, 0.3));
  ASSERT_TRUE(found.converged);
  const Pose X_WF = tip(seven, found.q, "tool");
  EXPECT_LT((X_WF.linear().col(2) + Vec3::UnitZ()).norm(), 2e-6);
  EXPECT_GT(angle_between(X_WF, down.X_WT), 0.01);  // about that axis it has stayed where it was convenient
}

TEST(InverseKinematics, SeveralFramesReachTheirTargetsTogether) {
  RobotModel arm = test::seven_joint_arm();
  arm.frames.push_back({"tip", 4, Pose::Identity()});
  std::mt19937_64 random(3);
  const VecX q = random_positions(arm, random);
  const std::vector<FrameTarget> targets{{*arm.find_frame("tool"), tip(arm, q, "tool")}, point(arm, tip(arm, q).translation())};
  const IkResult found = solve_ik(arm, targets, random_positions(arm, random));
  ASSERT_TRUE(found.converged);
  EXPECT_LT((tip(arm, found.q).translation() - tip(arm, q).translation()).norm(), 1e-6);
  EXPECT_LT((tip(arm, found.q, "tool").translation() - tip(arm, q, "tool").translation()).norm(), 1e-6);
}

TEST(InverseKinematics, TheRestPostureIsApproachedAsFarAsTheTargetAllows) {
  const RobotModel arm = test::seven_joint_arm();
  std::mt19937_64 random(5);
  for (int i = 0; i < 5; ++i) {
    const VecX q_start = 0.6 * random_positions(arm, random), rest = 0.3 * random_positions(arm, random);
    const Pose X_WT = tip(arm, q_start, "tool");
    const IkResult found = solve_ik(arm, {{*arm.find_frame("tool"), X_WT}}, q_start, {.rest = rest});
    ASSERT_TRUE(found.converged);
    EXPECT_LE((found.q - rest).norm(), (q_start - rest).norm());
    // At the nearest solution what is left of the way is normal to the solutions: a combination of rows of J (no joint is at a limit).
    ASSERT_LT((found.q.cwiseAbs() - VecX::NullaryExpr(7, [&](Eigen::Index k) { return arm.joints[k].upper; })).maxCoeff(), -1e-3);
    const std::vector<Pose> X = link_poses(arm, found.q);
    const MatX J = jacobian(arm, X, 7, tip(arm, found.q, "tool").translation());
    const VecX null = J.fullPivLu().kernel().col(0).normalized();
    EXPECT_NEAR(null.dot(rest - found.q), 0, 1e-5);
  }
}

TEST(InverseKinematics, JointsThatFollowMoveAlongAndJointsThatCarryNoTargetStay) {
  RobotModel arm = test::planar_arm(0.3, 0.3);
  arm.joints[1].mimic = Mimic{0, -2, 0};  // the tip moves along the x axis: x = 2 * 0.3 cos(q)
  arm.links.push_back({.name = "finger"});
  arm.joints.push_back({.name = "finger", .parent = 2, .axis = Vec3::UnitZ()});
  FrameTarget x = point(arm, {0.36, 0, 0});
  const IkResult found = solve_ik(arm, {x}, Vec3(0.2, 0, 0.123), {.rest = Vec3(1, 1, 1)});
  ASSERT_TRUE(found.converged);
  EXPECT_NEAR(found.q[0], std::acos(0.6), 1e-5);
  EXPECT_EQ(found.q[1], -2 * found.q[0]);
  EXPECT_EQ(found.q[2], 0.123);
}

TEST(InverseKinematics, TheBaseCarriesTheArm) {
  const RobotModel arm = test::planar_arm(0.3, 0.2);
  const Pose X_WB(Eigen::Translation3d(1, 2, 3) * Eigen::AngleAxisd(0.5, Vec3::UnitX()));
  FrameTarget target = point(arm, X_WB * Vec3(0.1, 0.3, 0));
  EXPECT_TRUE(solve_ik(arm, {target}, Eigen::Vector2d(0.2, 0.4), {}, X_WB).converged);
}

TEST(InverseKinematics, PositionsOfTheWrongNumberAreRefused) {
  const RobotModel arm = test::planar_arm(0.3, 0.2);
  EXPECT_THAT([&] { solve_ik(arm, {}, VecX::Zero(3)); },
              ThrowsMessage<InputError>(HasSubstr("the start has 3 joint positions for 2 joints")));
  EXPECT_THAT([&] { solve_ik(arm, {}, VecX::Zero(2), {.rest = VecX::Zero(1)}); },
              ThrowsMessage<InputError>(HasSubstr("the rest posture has 1")));
}
