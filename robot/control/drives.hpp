#pragma once
#include "robot/model/robot_model.hpp"

namespace robot {
/// Of one joint's drive; without gains it pushes only by the effort that is commanded.
struct DriveGains {
  Real kp = 0;                                          ///< [N m/rad or N/m]
  Real kd = 0;                                          ///< [N m s/rad or N s/m]
  Real effort = std::numeric_limits<Real>::infinity();  ///< [N m or N] limit, besides the one that the model names
};

/// What one drive is to do. position: spring and damper to `position` and `velocity`; velocity: the damper alone; effort: neither.
/// `effort` is pushed in every kind.
struct JointCommand {
  enum class Kind { position, velocity, effort };
  Kind kind = Kind::effort;
  Real position = 0;  ///< [rad or m]
  Real velocity = 0;  ///< [rad/s or m/s]
  Real effort = 0;    ///< [N m or N]
};

/// Force of each joint's drive as a function of the joint's velocity v' at the end of a substep: force - damping v'.
struct DriveLaw {
  VecX force;    ///< [nj] N m or N
  VecX damping;  ///< [nj] N m s/rad or N s/m
};

/// The drives of a robot's joints, implicit in each substep of length h [Tan 2011]: with q' = q + h v' the force of a joint is
///   f = clamp(kp (target - q - h v') + kd (target velocity - v') + effort + feed forward, +- limit)
/// The clamp is an active set: a joint in it gives its limit whatever v' is, and leaves it when its unclamped force is back within.
/// A joint that mimics another has no drive.
class Drives {
 public:
  /// @param gains  [nj], or empty: none
  /// @throws InputError if there are not as many as joints, or one is negative or NaN
  Drives(const RobotModel& model, const std::vector<DriveGains>& gains);

  /// @throws InputError if there are not as many as joints, or one is not finite
  void command(const std::vector<JointCommand>& commands);
  const std::vector<JointCommand>& commands() const { return commands_; }
  /// [nj] N m or N: what drives of kinds other than effort push in this substep beside what is commanded. Joints without gains are left
  /// out.
  void feed_forward(const VecX& effort);

  DriveLaw law(const VecX& q, Real h) const;
  /// Brings the active set in line with the velocity v' [nj] at the end of a substep from q; true if it changed.
  /// @param release  false: joints may only enter, so that repeating ends
  bool update_saturation(const VecX& q, const VecX& v, Real h, bool release);

  /// Stiffness [nj] N m/rad or N/m, and damping [nj], that a small external force meets now: those of saturated joints are zero.
  VecX stiffness() const;
  VecX damping() const;
  VecX limits() const;  ///< [nj] N m or N: most that each exerts

  /// [nj] -1, 0 or 1: the limit at which the drive stands.
  const std::vector<int>& saturation() const { return saturation_; }
  void set_saturation(std::vector<int> saturation) { saturation_ = std::move(saturation); }

 private:
  DriveLaw unclamped(const VecX& q, Real h) const;
  std::string name_;
  std::vector<DriveGains> gains_;  // effort: the smaller of both limits
  std::vector<JointCommand> commands_;
  VecX feed_forward_;  // [nj]
  std::vector<int> saturation_;
};

/// How far coordinates come [n x n, m per N and the like] per unit of a force held over count substeps of length h, with the mass
/// matrix frozen: per substep (M + h D + h^2 K) dv' = M dv - h K dx + h force, dx' = dx + h dv', from rest. For one substep
/// h^2 (M + h D + h^2 K)^-1.
/// @param stiffness, damping  [n] diagonals of K and D
MatX held_force_response(const MatX& M, const MatX& stiffness, const MatX& damping, Real h, int count);
}  // namespace robot
