#pragma once
#include <Eigen/Cholesky>
#include <cmath>
#include <memory>
#include <numbers>

#include "robot/model/primitives.hpp"
#include "robot/world/world.hpp"

/// Robots made for tests.
namespace robot::test {
using Model = std::shared_ptr<const RobotModel>;

inline Mat3 box_inertia(Real mass, const Vec3& size) {
  const Vec3 s = size.cwiseAbs2();
  return mass / 12 * Vec3(s.y() + s.z(), s.x() + s.z(), s.x() + s.y()).asDiagonal();
}
inline Pose at(const Vec3& p) { return Pose(Eigen::Translation3d(p)); }
inline Pose at(const Vec3& p, Real angle, const Vec3& axis) { return at(p) * Eigen::AngleAxisd(angle, axis.normalized()); }

/// A homogeneous box, its frame in its middle.
inline Model box(const Vec3& size, Real mass) {
  RobotModel model{.name = "box"};
  model.links = {{.name = "box", .inertial = {mass, Vec3::Zero(), box_inertia(mass, size)}, .collision = {box_shape(size)}}};
  return std::make_shared<RobotModel>(model);
}

/// What a link weighs if nothing is special about it: off-diagonal inertia, centre off the frame.
inline Inertial lopsided(Real mass, const Vec3& com) {
  const Mat3 R = Eigen::AngleAxisd(0.7, Vec3(1, 2, -1).normalized()).toRotationMatrix();
  const Mat3 I = R * box_inertia(mass, {0.1, 0.06, 0.25}) * R.transpose();
  return {mass, com, (I + I.transpose()) / 2};
}

/// One link on a hinge or slide at the world's origin.
inline Model one_joint(JointType type, const Vec3& axis, const Inertial& inertial, const Joint& like = {.name = "joint"}) {
  RobotModel model{.name = "one joint"};
  model.links = {{.name = "stand"}, {.name = "arm", .inertial = inertial}};
  Joint joint = like;
  joint.type = type;
  joint.axis = axis;
  model.joints = {joint};
  return std::make_shared<RobotModel>(model);
}

/// A tree of five moving links: turning and sliding joints about odd axes, at odd places, with two branches.
inline RobotModel tree() {
  RobotModel model{.name = "tree"};
  const auto odd = [](int k) { return Vec3(0.03 * k + 0.02, 0.05 - 0.01 * k, 0.08 + 0.02 * k); };
  for (int k = 0; k <= 5; ++k) model.links.push_back({.name = "link" + std::to_string(k), .inertial = lopsided(0.4 + 0.3 * k, odd(k) / 2)});
  const int parents[] = {0, 1, 1, 3, 4};
  for (int k = 0; k < 5; ++k) {
    Joint joint;
    joint.name = "joint" + std::to_string(k);
    joint.type = k == 2 ? JointType::prismatic : JointType::revolute;
    joint.parent = parents[k];
    joint.X_PJ = at(odd(k), 0.4 * k + 0.3, Vec3(1, -k, 2));
    joint.axis = Vec3(1 - k, 2, k).normalized();
    model.joints.push_back(joint);
  }
  return model;
}
inline VecX odd_numbers(Eigen::Index n, Real size) {
  VecX v(n);
  for (Eigen::Index k = 0; k < n; ++k) v[k] = size * std::sin(1.3 * static_cast<Real>(k) + 0.4);
  return v;
}
inline RobotState odd_state(const World& world, int robot, Real speed = 1) {
  const Eigen::Index joints = static_cast<Eigen::Index>(world.model(robot).joints.size());
  return {at({0.2, -0.1, 0.5}, 0.8, {1, 3, -2}), odd_numbers(joints, 0.6), odd_numbers(world.dof(robot), speed)};
}

/// Momentum [N s] and angular momentum [N m s] about the world's origin, link by link.
inline std::pair<Vec3, Vec3> momentum(const World& world, int robot) {
  Vec3 linear = Vec3::Zero(), angular = Vec3::Zero();
  const std::vector<Link>& links = world.model(robot).links;
  for (int link = 0; link < static_cast<int>(links.size()); ++link) {
    const Inertial& i = links[static_cast<std::size_t>(link)].inertial;
    const Pose X = world.link_pose(robot, link);
    const VecX v = world.link_velocity(robot, link);
    const Vec3 omega = v.tail<3>(), com = X * i.com, p = i.mass * (v.head<3>() + omega.cross(X.linear() * i.com));
    linear += p;
    angular += com.cross(p) + X.linear() * i.inertia * X.linear().transpose() * omega;
  }
  return {linear, angular};
}
/// [J] link by link.
inline Real kinetic_energy(const World& world, int robot) {
  Real energy = 0;
  const std::vector<Link>& links = world.model(robot).links;
  for (int link = 0; link < static_cast<int>(links.size()); ++link) {
    const Inertial& i = links[static_cast<std::size_t>(link)].inertial;
    const Mat3 R = world.link_pose(robot, link).linear();
    const VecX v = world.link_velocity(robot, link);
    const Vec3 omega = v.tail<3>(), v_com = v.head<3>() + omega.cross(R * i.com);
    energy += (i.mass * v_com.squaredNorm() + omega.dot(R * i.inertia * R.transpose() * omega)) / 2;
  }
  return energy;
}
}  // namespace robot::test
