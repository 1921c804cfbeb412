#include "robot/control/line_move.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "robot/control/motion_profile.hpp"
#include "robot/kinematics/forward_kinematics.hpp"

namespace robot {
namespace {
constexpr Real kRoundOff = 1e-9;  // relative

/// The straight way between two poses.
struct Line {
  Vec3 p0, p1;
  Eigen::Quaterniond R0, R1;

  Line(const Pose& from, const Pose& to) : p0(from.translation()), p1(to.translation()), R0(from.linear()), R1(to.linear()) {}
  Pose at(Real s) const { return Eigen::Translation3d(p0 + s * (p1 - p0)) * R0.slerp(s, R1); }
};

/// [s] of the move; what is free in all axes takes none.
Real shortest_time(const Line& line, const FrameTarget& target, const LineLimits& limits) {
  const Real way = target.position_weight.isZero(0) ? 0 : (line.p1 - line.p0).norm();
  const Real turn = target.rotation_weight.isZero(0) ? 0 : line.R0.angularDistance(line.R1);
  return std::max(MotionProfile::shortest_time(way, limits.speed, limits.acceleration),
                  MotionProfile::shortest_time(turn, limits.turning_speed, limits.turning_acceleration));
}

void require_positive(Real value, const char* name) {
  if (!(value > 0)) throw InputError(fmt::format("line move: {} = {:g} (allowed: > 0)", name, value));
}

/// Why a command cannot be followed; empty if it can.
std::string reason(const RobotModel& model, const IkResult& found, const VecX& q_before, Real dt) {
  if (!found.converged)
    return fmt::format("no joint positions nearer than {:g} m and {:g} rad", found.position_error, found.rotation_error);
  for (std::size_t k = 0; k < model.joints.size(); ++k) {
    const Real speed = std::fabs(found.q[k] - q_before[k]) / dt;
    if (speed > model.joints[k].velocity * (1 + kRoundOff))
      return fmt::format("joint {} would have to move at {:g} rad/s or m/s (allowed: {:g})", model.joints[k].name, speed,
                         model.joints[k].velocity);
  }
  return {};
}
}  // namespace

LineMove line_move(const RobotModel& model, const FrameTarget& target, const VecX& q_start, const LineLimits& limits,
                   const IkOptions& options, Real rate, const Pose& X_WB) {
  require_positive(limits.speed, "speed");
  require_positive(limits.acceleration, "acceleration");
  require_positive(limits.turning_speed, "turning speed");
  require_positive(limits.turning_acceleration, "turning acceleration");
  require_positive(rate, "rate");
  const Line line(frame_pose(link_poses(model, q_start, X_WB), target.frame), target.X_WT);
  const Real duration = shortest_time(line, target, limits);
  FrameTarget next = target;
  IkOptions near = options;
  near.restarts = 0;

  LineMove move{{{}, {0}, {q_start}, JointTrajectory::Between::linear}, 0, {}};
  for (const Joint& joint : model.joints) move.trajectory.joints.push_back(joint.name);
  const auto commands = static_cast<long>(std::ceil(duration * rate * (1 - kRoundOff)));
  for (long i = 1; i <= commands; ++i) {
    const Real s = MotionProfile::at(static_cast<Real>(i) / static_cast<Real>(commands)).value;
    next.X_WT = line.at(s);
    const VecX& q_before = move.trajectory.knots.back();
    const IkResult found = solve_ik(model, {next}, q_before, near, X_WB);
    move.failure = reason(model, found, q_before, 1 / rate);
    if (!move.failure.empty()) return move;
    move.trajectory.times.push_back(static_cast<Real>(i) / rate);
    move.trajectory.knots.push_back(found.q);
    move.fraction = s;
  }
  move.fraction = 1;
  return move;
}
}  // namespace robot
