#pragma once
#include <Eigen/Cholesky>

#include "robot/control/drives.hpp"
#include "robot/kinematics/joint_map.hpp"
#include "robot/world/articulation.hpp"
#include "robot/world/dry_friction.hpp"
#include "robot/world/world.hpp"

namespace robot {
/// A robot with its drives, and how one substep of length h changes its velocity (README.md).
class DrivenRobot {
 public:
  DrivenRobot(int index, const std::shared_ptr<const RobotModel>& model, const RobotParams& params);

  Articulation& body() { return body_; }
  const Articulation& body() const { return body_; }
  Drives& drives() { return drives_; }
  const Drives& drives() const { return drives_; }
  const std::vector<std::unique_ptr<btMultiBodyConstraint>>& constraints() const { return constraints_; }

  /// Joints that mimic follow exactly.
  VecX follow(const VecX& q) const { return joint_map_.all(joint_map_.independent_of(q)); }
  VecX follow_velocity(const VecX& v) const;
  void set_friction(int link, Real mu);
  /// [dof x k] motions that mimicking joints leave.
  const MatX& motions() const { return motions_; }
  /// d q_end / d tau over count substeps.
  MatX response(Real h, int count, bool drives) const;
  /// [independent joints] after a step of length dt.
  std::vector<JointHold> holds(Real dt) const;

  /// Configuration, velocity, commands and active sets as numbers, to the bit.
  void save(std::vector<Real>& numbers) const;
  void restore(const Real*& numbers);
  std::size_t saved_size() const { return 13 + 8 * static_cast<std::size_t>(body_.joints()); }

  /// At the start of a substep: what stays the same while contacts are sought, drives enter or leave their limits and joints slip or stick.
  void begin(const VecX& tau, const Vec3& gravity, Real h);
  /// Sets the velocity that drives, friction of the joints, external forces, weight and Coriolis forces lead to, before contacts and
  /// limits.
  void move_freely();
  /// [6 + nj x 6 + nj] change of Bullet's velocity per impulse, drives and friction of the joints giving way as they do within a substep.
  const MatX& impulse_response();
  /// After contacts and the like; true if a drive must enter or leave its limit, or a joint slip or stick, and the substep be made again.
  bool update_active_sets(bool release);
  /// Sets the velocity with which the configuration moves: a free base turns as the Coriolis forces make it in mid substep.
  void set_drift();
  /// After the configuration has changed: gives a free base the momentum that it has got (README.md), books the drives' impulse.
  void end();

  /// [nj] N m s or N s: of the drives, of dry friction and of limits, since they were last set to zero.
  VecX drive_impulse, friction_impulse, limit_impulse;

 private:
  void add_limits();
  MatX on_joints(const VecX& diagonal) const;
  MatX independent(const MatX& A) const;
  VecX give(const VecX& impulse) const;
  Articulation body_;
  Drives drives_;
  DryFriction friction_;
  JointMap joint_map_;
  bool compensate_gravity_;
  VecX viscous_;  // [nj]
  MatX motions_;
  std::vector<std::unique_ptr<btMultiBodyConstraint>> constraints_;

  // of the substep
  Real h_ = 0;
  Vec3 gravity_ = Vec3::Zero();
  VecX tau_, q_, v_start_, v_free_, v_end_;
  Eigen::Matrix<Real, 6, 1> weight_ = Eigen::Matrix<Real, 6, 1>::Zero();
  Vec3 origin_ = Vec3::Zero();   // of the base's frame at the start
  DriveLaw law_, friction_law_;  // law_: of the drives
  MatX M_;
  Eigen::LLT<MatX> K_;     // of the independent motions
  MatX impulse_response_;  // empty until asked for
};
}  // namespace robot
