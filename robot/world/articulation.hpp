#pragma once
#include "robot/world/collision_shape.hpp"

namespace robot {
/// A robot as Bullet holds it, in the coordinates of world.hpp. Bullet wants each link's frame at its centre of mass along its
/// principal axes (frame C), and its velocities [6 + nj] are those of the base's centre of mass, angular first, then the joints'.
class Articulation {
 public:
  /// @throws InputError if a link that moves has no mass or inertia, or the tree is out of order
  Articulation(int index, std::shared_ptr<const RobotModel> model, const Pose& X_WB, bool fixed_base);

  const RobotModel& model() const { return *model_; }
  btMultiBody& bullet() { return *body_; }
  btMultiBodyLinkCollider& collider(int link) { return *colliders_.at(static_cast<std::size_t>(link)); }
  Eigen::Index joints() const { return static_cast<Eigen::Index>(model_->joints.size()); }
  Eigen::Index base_dof() const { return fixed_base_ ? 0 : 6; }
  Eigen::Index dof() const { return base_dof() + joints(); }

  VecX q() const;
  VecX v() const;
  void set_base(const Pose& X_WB);
  void set_q(const VecX& q);
  void set_v(const VecX& v);
  /// Bullet's own numbers of configuration and velocity, to the bit; `restore` takes them from the front of what is left to read.
  void save(std::vector<Real>& numbers) const;
  void restore(const Real*& numbers);
  /// Brings all that follows from the configuration up to date: Bullet's caches, colliders, link poses. After every change of it.
  void refresh();

  const Pose& X_WL(int link) const { return X_WL_.at(static_cast<std::size_t>(link)); }
  /// Of velocities of the link's frame at the point p [m], linear then angular, by v.
  MatX jacobian(int link, const Vec3& p) const;
  MatX mass_matrix() const;
  /// [6 + nj x dof] Bullet's velocities by v; its transpose takes Bullet's forces to ours.
  MatX to_bullet_velocity() const;
  /// Force [N] and torque [N m] of the weight about the base frame's origin.
  Eigen::Matrix<Real, 6, 1> weight(const Vec3& gravity) const;
  /// [nj] N m or N: of the weight of all links beyond each joint, in its direction.
  VecX joint_weight(const Vec3& gravity) const;
  /// dv/dt at this configuration if the velocity were v, under the weight, tau [dof], and nothing else.
  VecX acceleration(const VecX& v, const VecX& tau, const Vec3& gravity);

 private:
  using Vec6 = Eigen::Matrix<Real, 6, 1>;
  using Mat6 = Eigen::Matrix<Real, 6, 6>;
  const Pose& X_LC(int link) const { return X_LC_[static_cast<std::size_t>(link)]; }
  void setup_link(int joint);
  void add_collider(int index, int link);
  Vec6 joint_motion(int joint) const;
  Mat6 spatial_inertia(int link) const;

  std::shared_ptr<const RobotModel> model_;
  bool fixed_base_;
  std::vector<Pose> X_LC_, X_WL_;  // [links]
  std::vector<Vec3> moments_;      // [links] kg m^2, principal
  std::vector<std::unique_ptr<CollisionShape>> shapes_;
  std::unique_ptr<btMultiBody> body_;
  std::vector<std::unique_ptr<btMultiBodyLinkCollider>> colliders_;
  btAlignedObjectArray<btScalar> scratch_r_;
  btAlignedObjectArray<btVector3> scratch_v_;
  btAlignedObjectArray<btMatrix3x3> scratch_m_;
  btAlignedObjectArray<btQuaternion> scratch_q_;
};
}  // namespace robot
