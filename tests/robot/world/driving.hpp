#pragma once
#include <algorithm>

#include "robot/control/trajectory.hpp"
#include "robot/kinematics/forward_kinematics.hpp"
#include "robot/world/world.hpp"

/// Robots on drives, and what their drives have to give.
namespace robot::test {
/// Gains of the arms' and hands' drives in the authors' demonstration scene.
inline DriveGains arm_drive(int joint) {
  constexpr Real kKp[] = {7200, 7200, 7200, 3600, 3600, 3600, 3600}, kKd[] = {600, 600, 600, 400, 200, 200, 200};
  return {.kp = kKp[joint], .kd = kKd[joint]};
}
constexpr DriveGains kFingerDrive{.kp = 50, .kd = 0.5};
/// Of an arm, of a hand, or of a robot with both: arms have joints named ...arm_joint1 to 7, and other joints are fingers.
inline std::vector<DriveGains> drives_of(const RobotModel& model) {
  std::vector<DriveGains> drives;
  for (const Joint& joint : model.joints)
    drives.push_back(joint.name.find("finger") == joint.name.npos ? arm_drive(joint.name.back() - '1') : kFingerDrive);
  return drives;
}

inline std::vector<JointCommand> hold(const VecX& q) {
  std::vector<JointCommand> commands;
  for (const Real position : q) commands.push_back({.kind = JointCommand::Kind::position, .position = position});
  return commands;
}
/// The joints of a trajectory are to be at a point of it at the end of the next step; the others stay at their commands. As a substep moves
/// by its last velocity, the velocity that goes with it is that of the step's middle.
inline void command(std::vector<JointCommand>& commands, const std::vector<int>& joints, const JointTrajectory::Point& point) {
  for (std::size_t j = 0; j < joints.size(); ++j) {
    const auto k = static_cast<Eigen::Index>(j);
    commands[static_cast<std::size_t>(joints[j])] = {.kind = JointCommand::Kind::position, .position = point.q[k], .velocity = point.v[k]};
  }
}

/// Torque [nj] of the weight that the joints of a robot with a fixed base carry: sum over links of m g J_com.
inline VecX weight_torque(const RobotModel& model, const VecX& q, const Vec3& gravity = {0, 0, -9.81}) {
  const std::vector<Pose> X = link_poses(model, q);
  VecX torque = VecX::Zero(q.size());
  for (std::size_t l = 0; l < model.links.size(); ++l) {
    const Inertial& i = model.links[l].inertial;
    torque += jacobian(model, X, static_cast<int>(l), X[l] * i.com).topRows<3>().transpose() * (i.mass * gravity);
  }
  return torque;
}

/// What a drive with gains kp, kd has to give at a motion's worst, by joint [nj]: M a + Coriolis forces and weight, damping, dry friction.
/// As kp e + kd de/dt is that torque, the error e is it, by kp, seen through a first-order filter of gain 1: never more than its largest
/// value.
class WorstTorque {
 public:
  explicit WorstTorque(const std::shared_ptr<const RobotModel>& model)
      : torque_(VecX::Zero(static_cast<Eigen::Index>(model->joints.size()))) {
    robot_ = world_.add_robot(model);
  }
  void add(const VecX& q, const VecX& v, const VecX& a) {
    world_.set_state(robot_, {Pose::Identity(), q, v});
    VecX tau = world_.mass_matrix(robot_) * (a - world_.acceleration(robot_, VecX::Zero(q.size())));
    for (Eigen::Index k = 0; k < q.size(); ++k) {
      const Joint& joint = world_.model(robot_).joints[static_cast<std::size_t>(k)];
      torque_[k] = std::max(torque_[k], std::abs(tau[k]) + joint.damping * std::abs(v[k]) + joint.friction);
    }
  }
  const VecX& torque() const { return torque_; }

 private:
  World world_;
  int robot_ = 0;
  VecX torque_;
};
}  // namespace robot::test
