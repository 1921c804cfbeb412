#pragma once
#include "robot/control/inverse_kinematics.hpp"
#include "robot/control/trajectory.hpp"

namespace robot {
/// How fast a frame moves, rest to rest with MotionProfile; all > 0.
struct LineLimits {
  Real speed = 0.1;                 ///< [m/s]
  Real acceleration = 0.5;          ///< [m/s^2]
  Real turning_speed = 0.5;         ///< [rad/s]
  Real turning_acceleration = 2.5;  ///< [rad/s^2]
};

/// Joint commands that move a frame along a straight line, until where they could follow.
struct LineMove {
  JointTrajectory trajectory;  ///< of all joints of the model, linear between commands
  Real fraction = 0;           ///< [0, 1] of the way that it covers
  std::string failure;         ///< why it ends there, naming the joint or the error; empty: it has arrived
};

/// Moves a frame from where it is at q_start [nj rad or m] straight to its target: p = p_0 + s (p_1 - p_0), R = slerp(R_0, R_1, s), s(t)
/// from rest to rest in the shortest time within the limits, and turns it into commands by inverse kinematics from command to command. What
/// cannot be followed within the tolerances, the joints' limits or their speed limits (difference of two commands by their time) ends the
/// move there: a value, not an exception.
/// @param target   axes without weight are free on the way too
/// @param options  of inverse kinematics; restarts are not used, as they would jump between solutions
/// @param rate     [1/s] of commands
/// @throws InputError if limits or rate are not positive; as solve_ik
LineMove line_move(const RobotModel& model, const FrameTarget& target, const VecX& q_start, const LineLimits& limits = {},
                   const IkOptions& options = {}, Real rate = 100, const Pose& X_WB = Pose::Identity());
}  // namespace robot
