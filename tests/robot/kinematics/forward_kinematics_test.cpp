#include "robot/kinematics/forward_kinematics.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "robot/kinematics/joint_map.hpp"
#include "tests/robot/kinematics/arms.hpp"
using namespace robot;
using testing::HasSubstr;
using testing::ThrowsMessage;

namespace {
/// A turning, a sliding and a turning joint along skew axes with tilted frames, on two branches.
RobotModel skew_tree() {
  RobotModel model;
  model.name = "skew";
  model.links = {{.name = "base"}, {.name = "a"}, {.name = "b"}, {.name = "c"}};
  const auto placed = [](const Vec3& p, const Vec3& turn) {
    return Pose(Eigen::Translation3d(p) * Eigen::AngleAxisd(turn.norm(), turn.normalized()));
  };
  model.joints = {{.name = "ja", .X_PJ = placed({0.1, -0.2, 0.3}, {0.3, 0.2, -0.5}), .axis = Vec3(1, 2, 3).normalized()},
                  {.name = "jb",
                   .type = JointType::prismatic,
                   .parent = 1,
                   .X_PJ = placed({0, 0.4, 0.1}, {1, -1, 0.4}),
                   .axis = Vec3(2, -1, 1).normalized()},
                  {.name = "jc",
                   .type = JointType::continuous,
                   .parent = 1,
                   .X_PJ = placed({0.2, 0, -0.3}, {-0.7, 0.1, 0.9}),
                   .axis = Vec3(-1, 1, 2).normalized()}};
  return model;
}
const Pose kBase(Eigen::Translation3d(1, 2, 3) * Eigen::AngleAxisd(0.8, Vec3(3, -1, 2).normalized()));
}  // namespace

TEST(ForwardKinematics, TipOfAPlanarArmIsWhereTrigonometryPutsIt) {
  const RobotModel arm = test::planar_arm(0.3, 0.2);
  for (const auto& [s, e] : {std::pair{0., 0.}, {0.4, 0.9}, {-2.1, 1.3}, {3, -2}}) {
    const Pose X_WT = frame_pose(link_poses(arm, Eigen::Vector2d(s, e)), *arm.find_frame("tip"));
    const Vec3 tip(0.3 * std::cos(s) + 0.2 * std::cos(s + e), 0.3 * std::sin(s) + 0.2 * std::sin(s + e), 0);
    EXPECT_LT((X_WT.translation() - tip).norm(), 1e-15);
    EXPECT_NEAR(std::remainder(std::atan2(X_WT(1, 0), X_WT(0, 0)) - s - e, 2 * std::numbers::pi), 0, 1e-15);
  }
}

TEST(ForwardKinematics, APoseIsTheProductOfTheTransformsOnItsWayAndABranchDoesNotMoveTheOther) {
  const RobotModel model = skew_tree();
  const Vec3 q(0.7, -0.15, 2.2);
  const std::vector<Pose> X = link_poses(model, q, kBase);
  const auto turn = [&](int k) { return Pose(Eigen::AngleAxisd(q[k], model.joints[k].axis)); };
  const Pose a = kBase * model.joints[0].X_PJ * turn(0);
  const Pose b = a * model.joints[1].X_PJ * Eigen::Translation3d(q[1] * model.joints[1].axis);
  const Pose c = a * model.joints[2].X_PJ * turn(2);
  EXPECT_TRUE(X[0].isApprox(kBase, 1e-15));
  EXPECT_TRUE(X[1].isApprox(a, 1e-14));
  EXPECT_TRUE(X[2].isApprox(b, 1e-14));
  EXPECT_TRUE(X[3].isApprox(c, 1e-14));
}

TEST(ForwardKinematics, JacobianIsTheCentralDifferenceOfAPointAndOfTheRotation) {
  const RobotModel model = skew_tree();
  const Vec3 q(0.7, -0.15, 2.2), p_L(0.11, -0.07, 0.05);
  const Real h = 1e-5;
  const std::vector<Pose> X = link_poses(model, q, kBase);
  for (int link : {0, 1, 2, 3}) {
    const MatX J = jacobian(model, X, link, X[link] * p_L);
    ASSERT_EQ(J.cols(), 3);
    for (int k = 0; k < 3; ++k) {
      const Pose plus = link_poses(model, q + h * Vec3::Unit(k), kBase)[link],
                 minus = link_poses(model, q - h * Vec3::Unit(k), kBase)[link];
      const Eigen::AngleAxisd turn(plus.linear() * minus.linear().transpose());
      EXPECT_LT((J.col(k).head<3>() - (plus * p_L - minus * p_L) / (2 * h)).norm(), 1e-10) << "link " << link << ", joint " << k;
      EXPECT_LT((J.col(k).tail<3>() - turn.angle() * turn.axis() / (2 * h)).norm(), 1e-10) << "link " << link << ", joint " << k;
    }
  }
}

TEST(ForwardKinematics, AWrongNumberOfPositionsIsRefused) {
  EXPECT_THAT([] { link_poses(test::planar_arm(1, 1), VecX::Zero(3)); },
              ThrowsMessage<InputError>(HasSubstr("planar: 3 joint positions for its 2")));
}

TEST(JointMap, JointsThatFollowThoseThatFollowAreResolvedAndTheirLimitsNarrowThoseOfTheLeader) {
  RobotModel model = skew_tree();
  model.joints[0].mimic = Mimic{2, -2, 0.1};   // a = 0.1 - 2 c
  model.joints[1].mimic = Mimic{0, 0.5, 0.3};  // b = 0.35 - c
  model.joints[0].lower = -0.5;                // c <= 0.3
  model.joints[1].upper = 0.6;                 // c >= -0.25
  model.joints[2].lower = -0.2;
  const JointMap map = joint_map(model);
  EXPECT_EQ(map.independent, std::vector<int>{2});
  EXPECT_LT((map.all(VecX::Constant(1, 0.2)) - Vec3(-0.3, 0.15, 0.2)).norm(), 1e-15);
  EXPECT_DOUBLE_EQ(map.lower[0], -0.2);
  EXPECT_DOUBLE_EQ(map.upper[0], 0.3);
  EXPECT_EQ(map.independent_of(Vec3(1, 2, 3))[0], 3);
}

TEST(JointMap, JacobianByTheIndependentJointsIsTheDifferenceOfAPoseWhoseFollowersMoveAlong) {
  RobotModel model = skew_tree();
  model.joints[1].mimic = Mimic{0, 0.4, 0.02};
  const JointMap map = joint_map(model);
  const Eigen::Vector2d u(0.3, 0.5);
  const Real h = 1e-5;
  const std::vector<Pose> X = link_poses(model, map.all(u));
  const MatX J = jacobian(model, X, 2, X[2].translation()) * map.map;
  const Vec3 slope = (link_poses(model, map.all(u + Eigen::Vector2d(h, 0)))[2].translation() -
                      link_poses(model, map.all(u - Eigen::Vector2d(h, 0)))[2].translation()) /
                     (2 * h);
  EXPECT_LT((J.col(0).head<3>() - slope).norm(), 1e-10);
  EXPECT_EQ(J.col(1).norm(), 0);
}

TEST(JointMap, CirclesUnknownJointsAndLimitsThatExcludeEachOtherAreRefusedByName) {
  RobotModel circle = skew_tree();
  circle.joints[0].mimic = Mimic{1};
  circle.joints[1].mimic = Mimic{0};
  EXPECT_THAT([&] { joint_map(circle); }, ThrowsMessage<InputError>(HasSubstr("joint ja: follows itself")));
  RobotModel alone = skew_tree();
  alone.joints[1].mimic = Mimic{7};
  EXPECT_THAT([&] { joint_map(alone); }, ThrowsMessage<InputError>(HasSubstr("joint jb: the joint that it mimics is none")));
  RobotModel narrow = skew_tree();
  narrow.joints[1].mimic = Mimic{0, 1, 1};
  narrow.joints[0].lower = 0;
  narrow.joints[1].upper = 0.5;
  EXPECT_THAT([&] { joint_map(narrow); }, ThrowsMessage<InputError>(HasSubstr("joint jb: its limits and those of joint ja")));
}
