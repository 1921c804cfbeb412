#pragma once
#include <vector>

#include "robot/control/drives.hpp"

namespace robot {
/// Coulomb friction of a robot's joints, implicit in a substep: f = clamp(-damping v', +- friction), a damper so stiff that what sticks
/// creeps by at most 1e-7 rad/s or m/s. It is no stiffer, for the sweeps over contacts and limits converge slowly where what sticks holds
/// something light: what they leave must be little of the friction.
class DryFriction {
 public:
  explicit DryFriction(const RobotModel& model);

  DriveLaw law() const;
  /// Brings the active set in line with the velocity v' [nj] at the end of a substep; true if it changed.
  /// @param release  false: joints may only start to slip
  bool update(const VecX& v, bool release);

  const VecX& friction() const { return friction_; }  ///< [nj] N m or N, most that each exerts
  /// [nj] -1, 0 or 1: the sign of the friction of joints that slip.
  const std::vector<int>& slipping() const { return slipping_; }
  void set_slipping(std::vector<int> slipping) { slipping_ = std::move(slipping); }

 private:
  VecX friction_, damping_;  // [nj]
  std::vector<int> slipping_;
};
}  // namespace robot
