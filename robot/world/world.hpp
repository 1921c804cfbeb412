#pragma once
#include <functional>
#include <memory>

#include "robot/control/drives.hpp"

namespace robot {
struct WorldParams {
  Vec3 gravity = {0, 0, -9.81};  ///< [m/s^2]
  Real substep = 1e-3;           ///< [s] longest step of the physics
  int iterations = 50;           ///< most sweeps of the contact solver over its rows in a substep
  Real contact_erp = 0.1;        ///< share of a penetration that a substep takes back
  Real limit_erp = 0.2;          ///< share of a joint limit's violation that a substep takes back
};

struct RobotParams {
  Pose X_WB = Pose::Identity();         ///< of the base at the start
  bool fixed_base = true;               ///< false: the base is free
  std::vector<DriveGains> drives = {};  ///< [nj], or empty: none
  bool compensate_gravity = false;      ///< position and velocity drives also push what carries the robot's own links (README.md)
  Real friction = 0.5;                  ///< of every link; of a pair, the geometric mean of both
};

/// Velocities v [dof] are, if the base is free, those of the base's frame in world axes, linear then angular, and then the joints';
/// forces [dof] are what works on them: a force and a torque about the base frame's origin, then the joints'.
struct RobotState {
  Pose X_WB = Pose::Identity();
  VecX q;  ///< [nj] rad or m
  VecX v;  ///< [dof] m/s, rad/s
};

/// What keeps an independent joint where it is, beside its drive and contacts: its dry friction, if it sticks, and its limit, if that has
/// acted in the last step or the joint stands at it; of the joints that follow it too.
struct JointHold {
  Real effort = 0;           ///< [N m or N] that they exert, mean over the last step
  Real least = 0, most = 0;  ///< [N m or N] between which that may change while the joint stands still; both 0: nothing holds it
  bool stopped = false;      ///< a limit holds it, too
};

/// Where links touch in a step; points of its substeps that are as near to each other as links come before they count as touching are one.
struct Contact {
  int robot_a = 0, link_a = 0, robot_b = 0, link_b = 0;
  Vec3 point;         ///< [m] on b
  Vec3 normal;        ///< from b to a
  Vec3 force;         ///< [N] of b on a, mean over the step
  Real mu = 0;        ///< [1] friction of the pair
  Real distance = 0;  ///< [m] before the last substep in which it touches; negative: penetration
};

/// Everything that the next step depends on, as numbers that may be written to a file. It fits worlds built by the same calls.
struct Snapshot {
  std::vector<Real> numbers;
};

/// Robots and props in Bullet, all of them as articulations: a prop is a robot without joints. README.md of this folder says how a
/// substep is made. `robot` and `link` are indices: of the call of add_robot, and into the model's links.
class World {
 public:
  explicit World(const WorldParams& params = {});
  ~World();
  World(World&&) noexcept;
  World& operator=(World&&) noexcept;

  /// @throws InputError where the model or a parameter cannot be simulated
  int add_robot(std::shared_ptr<const RobotModel> model, const RobotParams& params = {});
  int robots() const;
  const RobotModel& model(int robot) const;
  /// Joints, and 6 if the base is free.
  int dof(int robot) const;

  RobotState state(int robot) const;
  /// Mimicking joints are set by those that they mimic.
  void set_state(int robot, const RobotState& state);
  void command(int robot, const std::vector<JointCommand>& commands);
  void set_friction(int robot, int link, Real mu);
  /// Whether this pair of links may touch in Bullet: not, where another solver sees to it.
  void set_contact(int robot_a, int link_a, int robot_b, int link_b, bool on);
  bool may_touch(int robot_a, int link_a, int robot_b, int link_b) const;

  /// Advances by dt [s] in equal substeps.
  /// @param tau     [robots] external force on each [dof], held over dt; an empty one, or an empty list, is none
  /// @param before  called before each substep with the time [s] since the start at which it ends: it may command
  void step(Real dt, const std::vector<VecX>& tau = {}, const std::function<void(Real)>& before = {});
  Snapshot save() const;
  /// What is reported of the last step (drive_effort, holds, contacts, unsettled_substeps) is not kept.
  void restore(const Snapshot& snapshot);

  Pose link_pose(int robot, int link) const;
  /// [6] m/s, rad/s: of the link's frame, linear then angular, world axes.
  VecX link_velocity(int robot, int link) const;
  /// [6 x dof] of link_velocity by v.
  MatX jacobian(int robot, int link) const;
  MatX mass_matrix(int robot) const;
  /// [dof] mass matrix times v. If the base is free its first six are the momentum, linear and about the base frame's origin.
  VecX generalized_momentum(int robot) const;
  /// [dof] dv/dt under gravity and tau alone: no drive, damping, contact, limit or mimic. By Bullet's articulated-body algorithm.
  VecX acceleration(int robot, const VecX& tau) const;

  /// Motions that mimicking joints leave: [dof x k], v = motions * independent velocities; the identity if there are none.
  MatX motions(int robot) const;
  /// d(coordinates after dt)/d(force held over dt) [dof x dof] through the drives' substeps, the mass matrix frozen; of rank k.
  /// Contacts, limits and Coulomb friction do not enter.
  /// @param drives  false: as if all drives stood at their limits
  MatX response(int robot, Real dt, bool drives = true) const;

  /// [nj] N m or N: of the drives, mean over the last step.
  VecX drive_effort(int robot) const;
  /// [nj] N m or N: most that each drive exerts; infinite where neither the model nor its gains name a limit.
  VecX effort_limit(int robot) const;
  /// [independent joints]
  std::vector<JointHold> holds(int robot) const;
  /// [nj] -1, 0 or 1: the effort limit at which each drive stood in the last substep.
  std::vector<int> saturation(int robot) const;
  std::vector<Contact> contacts() const;
  /// Where links that may touch are inside each other as they stand, without forces, the deepest point first.
  std::vector<Contact> overlaps() const;
  /// Substeps of the last step in which drives' limits, joints' friction and contacts did not agree, so that joints may only slip and
  /// drives may only stand at their limits (README.md).
  int unsettled_substeps() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};
}  // namespace robot
