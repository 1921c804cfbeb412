#include "robot/control/trajectory.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "robot/control/motion_profile.hpp"

namespace robot {
namespace {
constexpr Real kRoundOff = 1e-9;  // relative: a time that is just long enough is long enough

void require_waypoints(const std::vector<std::string>& joints, const std::vector<VecX>& waypoints, const MotionLimits& limits) {
  const auto n = static_cast<Eigen::Index>(joints.size());
  if (limits.speed.size() != n || limits.acceleration.size() != n)
    throw InputError(fmt::format("trajectory: limits of {} speeds and {} accelerations for {} joints", limits.speed.size(),
                                 limits.acceleration.size(), n));
  for (Eigen::Index j = 0; j < n; ++j)
    if (!(limits.speed[j] > 0 && limits.acceleration[j] > 0))
      throw InputError(fmt::format("trajectory: joint {}: limits of speed {:g} and acceleration {:g} (allowed: > 0)", joints[j],
                                   limits.speed[j], limits.acceleration[j]));
  if (waypoints.empty()) throw InputError("trajectory: no waypoint (allowed: at least one)");
  for (std::size_t k = 0; k < waypoints.size(); ++k) {
    if (waypoints[k].size() != n)
      throw InputError(fmt::format("trajectory: waypoint {} has {} positions for {} joints", k, waypoints[k].size(), n));
    for (Eigen::Index j = 0; j < n; ++j)
      if (!std::isfinite(waypoints[k][j]))
        throw InputError(fmt::format("trajectory: waypoint {}, joint {} = {:g} is no number", k, joints[j], waypoints[k][j]));
  }
}

Real shortest_time(const VecX& move, const MotionLimits& limits) {
  Real time = 0;
  for (Eigen::Index j = 0; j < move.size(); ++j)
    time = std::max(time, MotionProfile::shortest_time(std::fabs(move[j]), limits.speed[j], limits.acceleration[j]));
  return time;
}
}  // namespace

JointTrajectory::Point JointTrajectory::at(Real t) const {
  const VecX zero = VecX::Zero(knots.front().size());
  if (t < start()) return {knots.front(), zero, zero};
  if (t >= end()) return {knots.back(), zero, zero};
  const auto k = static_cast<std::size_t>(std::upper_bound(times.begin(), times.end(), t) - times.begin()) - 1;
  const Real T = times[k + 1] - times[k], s = (t - times[k]) / T;
  const VecX move = knots[k + 1] - knots[k];
  const MotionProfile p = between == Between::linear ? MotionProfile{s, 1, 0} : MotionProfile::at(s);
  return {knots[k] + p.value * move, p.slope / T * move, p.curvature / (T * T) * move};
}

MotionLimits motion_limits(const RobotModel& model, const std::vector<std::string>& joints, Real fraction, Real acceleration) {
  if (!(fraction > 0 && fraction <= 1)) throw InputError(fmt::format("trajectory: fraction of speed = {:g} (allowed: 0 to 1)", fraction));
  if (!(acceleration > 0)) throw InputError(fmt::format("trajectory: acceleration = {:g} (allowed: > 0)", acceleration));
  MotionLimits limits{VecX(joints.size()), VecX::Constant(joints.size(), acceleration)};
  for (std::size_t j = 0; j < joints.size(); ++j) {
    const int k = model.find_joint(joints[j]);
    if (k < 0) throw InputError("robot " + model.name + ": there is no joint " + joints[j]);
    limits.speed[j] = fraction * model.joints[k].velocity;
  }
  return limits;
}

JointTrajectory trajectory_within(const std::vector<std::string>& joints, const std::vector<VecX>& waypoints, const MotionLimits& limits) {
  require_waypoints(joints, waypoints, limits);
  JointTrajectory result{joints, {0}, {waypoints.front()}};
  for (const VecX& waypoint : waypoints) {
    const Real time = shortest_time(waypoint - result.knots.back(), limits);
    if (time == 0) continue;
    result.times.push_back(result.end() + time);
    result.knots.push_back(waypoint);
  }
  return result;
}

JointTrajectory trajectory_at(const std::vector<std::string>& joints, const std::vector<VecX>& waypoints, const std::vector<Real>& times,
                              const MotionLimits& limits) {
  require_waypoints(joints, waypoints, limits);
  if (times.size() != waypoints.size())
    throw InputError(fmt::format("trajectory: {} times for {} waypoints", times.size(), waypoints.size()));
  for (std::size_t k = 0; k + 1 < times.size(); ++k) {
    const Real time = times[k + 1] - times[k];
    if (!(time > 0))
      throw InputError(fmt::format("trajectory: waypoint {}: time {:g} s is not after {:g} s", k + 1, times[k + 1], times[k]));
    const VecX move = (waypoints[k + 1] - waypoints[k]).cwiseAbs();
    for (Eigen::Index j = 0; j < move.size(); ++j) {
      const Real needed = MotionProfile::shortest_time(move[j], limits.speed[j], limits.acceleration[j]);
      if (needed > time * (1 + kRoundOff))
        throw InputError(fmt::format(
            "trajectory: waypoint {}, joint {}: peak speed {:g} and acceleration {:g} (allowed: {:g} and {:g}); in {:g} s, needs {:g} s",
            k + 1, joints[j], MotionProfile::peak_speed(move[j], time), MotionProfile::peak_acceleration(move[j], time), limits.speed[j],
            limits.acceleration[j], time, needed));
    }
  }
  return {joints, times, waypoints};
}

std::vector<VecX> sample(const JointTrajectory& trajectory, Real rate) {
  if (!(rate > 0)) throw InputError(fmt::format("trajectory: rate = {:g} 1/s (allowed: > 0)", rate));
  const Real ticks = (trajectory.end() - trajectory.start()) * rate;
  const auto whole = static_cast<long>(std::ceil(ticks * (1 - kRoundOff)));
  std::vector<VecX> q;
  for (long i = 0; i < whole; ++i) q.push_back(trajectory.at(trajectory.start() + static_cast<Real>(i) / rate).q);
  q.push_back(trajectory.knots.back());
  return q;
}
}  // namespace robot
