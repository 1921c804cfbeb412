#include "robot/world/dry_friction.hpp"

#include "robot/control/clamped_force.hpp"

namespace robot {
DryFriction::DryFriction(const RobotModel& model)
    : friction_(static_cast<Eigen::Index>(model.joints.size())), slipping_(model.joints.size(), 0) {
  constexpr Real kCreep = 1e-7;  // [rad/s or m/s]
  for (Eigen::Index k = 0; k < friction_.size(); ++k) friction_[k] = model.joints[static_cast<std::size_t>(k)].friction;
  damping_ = friction_ / kCreep;
}

DriveLaw DryFriction::law() const {
  DriveLaw law{VecX::Zero(friction_.size()), damping_};
  for (Eigen::Index k = 0; k < friction_.size(); ++k) {
    const int side = slipping_[static_cast<std::size_t>(k)];
    if (side == 0) continue;
    law.force[k] = side * friction_[k];
    law.damping[k] = 0;
  }
  return law;
}

bool DryFriction::update(const VecX& v, bool release) {
  bool changed = false;
  for (Eigen::Index k = 0; k < friction_.size(); ++k)
    changed |= update_side(slipping_[static_cast<std::size_t>(k)], -damping_[k] * v[k], friction_[k], release);
  return changed;
}
}  // namespace robot
