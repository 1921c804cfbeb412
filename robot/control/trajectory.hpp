#pragma once
#include "robot/model/robot_model.hpp"

namespace robot {
/// Joint positions over time, through knots:
///   q(t) = q_k + (q_k+1 - q_k) p((t - t_k) / (t_k+1 - t_k)),
/// p(s) = s, or the profile from rest to rest of MotionProfile. Before its first and after its last knot it stands still there.
struct JointTrajectory {
  enum class Between { linear, rest_to_rest };
  struct Point {
    VecX q, v, a;  ///< [n] rad, rad/s, rad/s^2 (m if it slides). Of a linear one: v after the knot, a zero
  };

  std::vector<std::string> joints;  ///< [n] names
  std::vector<Real> times;          ///< [nk] s, strictly increasing, at least one
  std::vector<VecX> knots;          ///< [nk][n] rad or m
  Between between = Between::rest_to_rest;

  Real start() const { return times.front(); }
  Real end() const { return times.back(); }
  Point at(Real t) const;
};

/// Limits of motion, > 0; infinite where there is none.
struct MotionLimits {
  VecX speed, acceleration;  ///< [n] rad/s, rad/s^2 (m if it slides)
};
/// Speed limits of the model's joints of these names, times `fraction` in (0, 1]; and one limit of acceleration for all: a URDF file has
/// none.
/// @throws InputError if a joint is not in the model or a number is out of range
MotionLimits motion_limits(const RobotModel& model, const std::vector<std::string>& joints, Real fraction, Real acceleration);

/// Through waypoints [nk][n] rad or m, at rest at each (a straight line in joint space between two), as fast as the limits allow; from
/// t = 0. A waypoint that repeats the one before takes no time.
/// Moves that do not stop are recorded ones: read_trajectory.
/// @throws InputError if sizes differ or a number is not finite
JointTrajectory trajectory_within(const std::vector<std::string>& joints, const std::vector<VecX>& waypoints, const MotionLimits& limits);

/// Through waypoints at times [nk] s, at rest at each.
/// @throws InputError if times do not increase, or a joint would exceed its limits: its name, the value, the limit and the time it needs
JointTrajectory trajectory_at(const std::vector<std::string>& joints, const std::vector<VecX>& waypoints, const std::vector<Real>& times,
                              const MotionLimits& limits);

/// Commands q [ns][n] rad or m at start + i / rate [1/s], and at the end.
/// @throws InputError if the rate is not positive
std::vector<VecX> sample(const JointTrajectory& trajectory, Real rate = 100);
}  // namespace robot
