#include "robot/world/dry_friction.hpp"

#include "robot/control/clamped_force.hpp"

namespace robot {
DryFriction::DryFriction(const RobotModel& model)
    : friction_(static_cast<Eigen::Index>(model.joints.size())), damping_(VecX::Zero(friction_.size())), slipping_(model.joints.size(), 0) {
  for (Eigen::Index k = 0; k < friction_.size(); ++k) friction_[k] = model.joints[static_cast<std::size_t>(k)].friction;
}

void DryFriction::begin(const VecX& inertia, Real h) {
  constexpr Real kStiff = 1e10;  // times the inertia; a Cholesky factorisation does not mind diagonals of different size
  for (Eigen::Index k = 0; k < friction_.size(); ++k) damping_[k] = friction_[k] > 0 ? kStiff * inertia[k] / h : 0;
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
