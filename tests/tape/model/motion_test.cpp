#include "tape/model/motion.hpp"

#include <gtest/gtest.h>

#include "tape/math/rotation.hpp"
using namespace tape;

namespace {
void expect_pose(const Pose& pose, const Vec3& position, const Vec3& rotation, const char* when) {
  EXPECT_LT((pose.position - position).norm(), 1e-14) << when;
  EXPECT_LT((pose.rotation - rotation_exp(rotation)).norm(), 1e-14) << when;
}
Body driven(bool ease) {
  Body body;
  body.motion = Motion::driven;
  body.waypoints = {{1, {rotation_exp({0, 0, 0.5}), {0, 0, 1}}}, {3, {rotation_exp({0, 0, 2.5}), {4, 0, 1}}, ease}};
  return body;
}
}  // namespace

TEST(Motion, ADrivenBodyGoesLinearlyBetweenWaypointsAndRestsOutside) {
  const Body body = driven(false);
  expect_pose(driven_pose(body, 0), {0, 0, 1}, {0, 0, 0.5}, "before");
  expect_pose(driven_pose(body, 1), {0, 0, 1}, {0, 0, 0.5}, "at the first");
  expect_pose(driven_pose(body, 1.5), {1, 0, 1}, {0, 0, 1.0}, "between");
  expect_pose(driven_pose(body, 3), {4, 0, 1}, {0, 0, 2.5}, "at the last");
  expect_pose(driven_pose(body, 9), {4, 0, 1}, {0, 0, 2.5}, "after");
}

TEST(Motion, EaseStartsAndEndsAtRest) {
  const Body body = driven(true);
  expect_pose(driven_pose(body, 2), {2, 0, 1}, {0, 0, 1.5}, "half way");
  expect_pose(driven_pose(body, 1.5), {4 * 0.15625, 0, 1}, {0, 0, 0.5 + 2 * 0.15625}, "s^2 (3 - 2 s) at 1/4");
  EXPECT_LT((driven_pose(body, 1 + 1e-4).position - driven_pose(body, 1).position).norm() / 1e-4, 1e-3);
  EXPECT_LT((driven_pose(body, 3).position - driven_pose(body, 3 - 1e-4).position).norm() / 1e-4, 1e-3);
}

TEST(Motion, TheRotationTurnsTheShortWayAboutOneAxis) {
  Body body;
  const Mat3 start = rotation_exp({0.4, 0.2, -0.1});
  const Vec3 turn(0.9, -1.1, 0.3);
  body.waypoints = {{0, {start, Vec3::Zero()}}, {1, {rotation_exp(turn) * start, Vec3::Zero()}}};
  EXPECT_LT((driven_pose(body, 0.25).rotation - rotation_exp(0.25 * turn) * start).norm(), 1e-14);
}

TEST(Motion, ADrivenBodyWithoutWaypointsKeepsItsVelocities) {
  Body body;
  body.pose.position = {1, 0, 0};
  body.velocity = {0, 0.1, 0};
  body.angular_velocity = {0, 0, 10};
  expect_pose(driven_pose(body, 2), {1, 0.2, 0}, {0, 0, 20}, "more than three turns");
}

TEST(Motion, AGripMovesEvenlyInItsMovesAndHoldsStillOutside) {
  Grip grip;
  EXPECT_EQ(grip_offset(grip, 2), Vec3::Zero());
  grip.motion = {{1, 1, {1, 0, 0}}, {3, 2, {0, 2, 0}}};
  EXPECT_EQ(grip_offset(grip, 0), Vec3::Zero());
  EXPECT_EQ(grip_offset(grip, 1.5), Vec3(0.5, 0, 0));
  EXPECT_EQ(grip_offset(grip, 2.5), Vec3(1, 0, 0));
  EXPECT_EQ(grip_offset(grip, 4), Vec3(1, 1, 0));
  EXPECT_EQ(grip_offset(grip, 6), Vec3(1, 2, 0));
}
