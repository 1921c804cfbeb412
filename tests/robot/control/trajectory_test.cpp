#include "robot/control/trajectory.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "robot/control/motion_profile.hpp"
#include "tests/robot/kinematics/arms.hpp"
using namespace robot;
using testing::AllOf;
using testing::HasSubstr;
using testing::ThrowsMessage;

namespace {
const std::vector<std::string> kJoints{"a", "b"};
const Real kInfinity = std::numeric_limits<Real>::infinity();
MotionLimits limits(Real va, Real vb, Real aa, Real ab) { return {Eigen::Vector2d(va, vb), Eigen::Vector2d(aa, ab)}; }
VecX pair(Real a, Real b) { return Eigen::Vector2d(a, b); }
}  // namespace

TEST(MotionProfile, SlopeAndCurvatureAreThoseOfTheValueAndVanishAtBothEnds) {
  const Real h = 1e-5;
  for (Real s : {0.1, 0.3, 0.5, 0.77}) {
    const MotionProfile p = MotionProfile::at(s), plus = MotionProfile::at(s + h), minus = MotionProfile::at(s - h);
    EXPECT_NEAR(p.slope, (plus.value - minus.value) / (2 * h), 1e-8);
    EXPECT_NEAR(p.curvature, (plus.slope - minus.slope) / (2 * h), 1e-8);
  }
  for (Real s : {0., 1.}) {
    const MotionProfile p = MotionProfile::at(s);
    EXPECT_EQ(p.value, s);
    EXPECT_EQ(p.slope, 0);
    EXPECT_EQ(p.curvature, 0);
  }
}

TEST(MotionProfile, PeaksAreThoseOfTheMinimumJerkPath) {
  EXPECT_DOUBLE_EQ(MotionProfile::peak_speed(1, 1), 1.875);  // 15/8, at s = 1/2
  EXPECT_DOUBLE_EQ(MotionProfile::at(0.5).slope, 1.875);
  EXPECT_NEAR(MotionProfile::peak_acceleration(1, 1), 5.7735026919, 1e-10);  // 10/sqrt(3)
  EXPECT_NEAR(MotionProfile::at(0.5 - std::sqrt(3.) / 6).curvature, 5.7735026919, 1e-10);
  EXPECT_DOUBLE_EQ(MotionProfile::shortest_time(2, 1.5, kInfinity), 2.5);  // 15/8 * 2 / 1.5
  EXPECT_NEAR(MotionProfile::shortest_time(2, kInfinity, 3), std::sqrt(5.7735026919 * 2 / 3), 1e-9);
}

TEST(Trajectory, WithinLimitsTheSlowestJointReachesItsLimitAndNoneExceedsIt) {
  const MotionLimits slow = limits(0.5, 1, 100, 100), soft = limits(100, 100, 2, 0.7);
  for (const MotionLimits& limit : {slow, soft}) {
    const JointTrajectory path = trajectory_within(kJoints, {pair(0, 1), pair(0.8, 0.2), pair(0.8, 0.5)}, limit);
    Real nearest = 0;
    for (int i = 0; i <= 10000; ++i) {
      const auto point = path.at(path.end() * i / 10000);
      const Real use = std::max((point.v.array().abs() / limit.speed.array()).maxCoeff(),
                                (point.a.array().abs() / limit.acceleration.array()).maxCoeff());
      ASSERT_LE(use, 1 + 1e-12);
      nearest = std::max(nearest, use);
    }
    EXPECT_GT(nearest, 1 - 1e-5);
  }
  EXPECT_DOUBLE_EQ(trajectory_within(kJoints, {pair(0, 1), pair(0.8, 0.2)}, slow).end(), 3);  // 15/8 * 0.8 / 0.5
}

TEST(Trajectory, ItPassesItsWaypointsExactlyAndAtRestAndStandsStillOutside) {
  const std::vector<VecX> waypoints{pair(0.1, -0.3), pair(0.7, 0.2), pair(-0.4, 0.2)};
  const JointTrajectory path = trajectory_at(kJoints, waypoints, {2, 3.1, 5}, limits(9, 9, 9, 9));
  for (std::size_t k = 0; k < 3; ++k) {
    const auto point = path.at(path.times[k]);
    EXPECT_EQ(point.q, waypoints[k]);
    EXPECT_EQ(point.v, pair(0, 0));
    EXPECT_EQ(point.a, pair(0, 0));
  }
  EXPECT_EQ(path.at(-10).q, waypoints.front());
  EXPECT_EQ(path.at(10).q, waypoints.back());
  EXPECT_EQ(path.at(10).v, pair(0, 0));
}

TEST(Trajectory, VelocityAndAccelerationAreTheSlopesOfThePosition) {
  const JointTrajectory path = trajectory_at(kJoints, {pair(0.1, -0.3), pair(0.7, 0.2)}, {1, 2.5}, limits(9, 9, 9, 9));
  const Real h = 1e-5;
  for (Real t : {1.2, 1.7, 2.3}) {
    EXPECT_LT((path.at(t).v - (path.at(t + h).q - path.at(t - h).q) / (2 * h)).norm(), 1e-8);
    EXPECT_LT((path.at(t).a - (path.at(t + h).v - path.at(t - h).v) / (2 * h)).norm(), 1e-8);
  }
  EXPECT_LT((path.at(1.75).q - pair(0.4, -0.05)).norm(), 1e-15);  // half way at half time
}

TEST(Trajectory, AWaypointThatRepeatsTheOneBeforeTakesNoTime) {
  const JointTrajectory stay = trajectory_within(kJoints, {pair(1, 2), pair(1, 2)}, limits(1, 1, 1, 1));
  EXPECT_EQ(stay.end(), 0);
  EXPECT_EQ(stay.at(0).q, pair(1, 2));
  EXPECT_EQ(stay.at(1).v, pair(0, 0));
}

TEST(Trajectory, SamplesStandAtTheRateAndTheLastIsTheEnd) {
  JointTrajectory line{{"a"}, {0, 0.095}, {VecX::Constant(1, 0), VecX::Constant(1, 0.95)}, JointTrajectory::Between::linear};
  const std::vector<VecX> q = sample(line);
  ASSERT_EQ(q.size(), 11u);  // 0, 0.01, ... 0.09 s and the end
  for (int i = 0; i < 10; ++i) EXPECT_NEAR(q[i][0], 0.1 * i, 1e-15);
  EXPECT_EQ(q.back()[0], 0.95);
  line.times = {0, 0.1 + 1e-13};  // a time that is a tick but for round-off gives no tick twice
  EXPECT_EQ(sample(line).size(), 11u);
}

TEST(Trajectory, SpeedLimitsComeFromTheModel) {
  const RobotModel arm = test::seven_joint_arm();
  const MotionLimits limit = motion_limits(arm, {"joint3", "joint1"}, 0.5, 4);
  EXPECT_EQ(limit.speed, pair(1, 1));  // half of 2 rad/s
  EXPECT_EQ(limit.acceleration, pair(4, 4));
  EXPECT_THAT([&] { motion_limits(arm, {"wrist"}, 1, 1); }, ThrowsMessage<InputError>(HasSubstr("no joint wrist")));
  EXPECT_THAT([&] { motion_limits(arm, {}, 1.5, 1); }, ThrowsMessage<InputError>(HasSubstr("1.5 (allowed: 0 to 1)")));
  EXPECT_THAT([&] { motion_limits(arm, {}, 1, 0); }, ThrowsMessage<InputError>(HasSubstr("acceleration = 0")));
}

TEST(Trajectory, WhatCannotBeDrivenIsRefusedByName) {
  const auto path = [](const std::vector<VecX>& waypoints, const std::vector<Real>& times) {
    return [=] { trajectory_at(kJoints, waypoints, times, limits(1, 0.5, 10, 10)); };
  };
  // 15/8 * 0.4 / 1 = 0.75 rad/s where 0.5 is allowed, for which it needs 1.5 s
  EXPECT_THAT(path({pair(0, 0), pair(0, 0.4)}, {0, 1}),
              ThrowsMessage<InputError>(AllOf(HasSubstr("joint b: peak speed 0.75"), HasSubstr("needs 1.5 s"))));
  EXPECT_NO_THROW(path({pair(0, 0), pair(0, 0.4)}, {0, 1.5})());
  EXPECT_THAT(path({pair(0, 0), pair(0, 0)}, {1, 1}), ThrowsMessage<InputError>(HasSubstr("waypoint 1: time 1 s is not after 1 s")));
  EXPECT_THAT(path({pair(0, 0), pair(0, std::nan(""))}, {0, 1}), ThrowsMessage<InputError>(HasSubstr("waypoint 1, joint b = nan")));
  EXPECT_THAT(path({pair(0, 0), VecX::Zero(3)}, {0, 1}), ThrowsMessage<InputError>(HasSubstr("waypoint 1 has 3 positions for 2 joints")));
  EXPECT_THAT(path({pair(0, 0)}, {0, 1}), ThrowsMessage<InputError>(HasSubstr("2 times for 1 waypoints")));
  EXPECT_THAT(path({}, {}), ThrowsMessage<InputError>(HasSubstr("no waypoint")));
  EXPECT_THAT([] { trajectory_within(kJoints, {pair(0, 0)}, limits(1, 0, 1, 1)); },
              ThrowsMessage<InputError>(HasSubstr("joint b: limits of speed 0")));
  EXPECT_THAT([] { sample({{"a"}, {0}, {VecX::Zero(1)}}, 0); }, ThrowsMessage<InputError>(HasSubstr("rate = 0")));
}
