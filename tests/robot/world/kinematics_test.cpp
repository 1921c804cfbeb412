// Configuration, velocities, Jacobians and mass matrices, without time passing.
#include <gtest/gtest.h>

#include "tests/robot/world/robots.hpp"
using namespace robot;
using namespace robot::test;

namespace {
/// The state moved by v for a time dt.
RobotState moved(const RobotState& s, const VecX& v, bool fixed, Real dt) {
  RobotState to = s;
  to.q += dt * v.tail(s.q.size());
  if (fixed) return to;
  to.X_WB.translation() += dt * v.head<3>();
  const Vec3 turn = dt * v.segment<3>(3);
  if (turn.norm() > 0) to.X_WB.linear() = Eigen::AngleAxisd(turn.norm(), turn.normalized()) * s.X_WB.linear();
  return to;
}
const Model kTree = std::make_shared<RobotModel>(tree());
}  // namespace

TEST(Kinematics, LinksStandWhereTheJointsPutThem) {
  for (const bool fixed : {true, false}) {
    World world;
    const int robot = world.add_robot(kTree, {.fixed_base = fixed});
    const RobotState s = odd_state(world, robot);
    world.set_state(robot, s);
    std::vector<Pose> X = {s.X_WB};
    for (std::size_t k = 0; k < kTree->joints.size(); ++k) {
      const Joint& joint = kTree->joints[k];
      const Real q = s.q[static_cast<Eigen::Index>(k)];
      const Pose move = joint.type == JointType::prismatic ? at(q * joint.axis) : at(Vec3::Zero(), q, joint.axis);
      X.push_back(X[static_cast<std::size_t>(joint.parent)] * joint.X_PJ * move);
    }
    for (int link = 0; link < 6; ++link)
      EXPECT_TRUE(world.link_pose(robot, link).isApprox(X[static_cast<std::size_t>(link)], 1e-14)) << "link " << link;
    const RobotState back = world.state(robot);
    EXPECT_TRUE(back.X_WB.isApprox(s.X_WB, 1e-14));
    EXPECT_TRUE(back.v.isApprox(s.v, 1e-14));
    EXPECT_EQ(back.q, s.q);
  }
}

TEST(Kinematics, TheJacobianIsTheSlopeOfTheLinksPose) {
  constexpr Real kStep = 1e-6;
  for (const bool fixed : {true, false}) {
    World world;
    const int robot = world.add_robot(kTree, {.fixed_base = fixed});
    const RobotState s = odd_state(world, robot);
    world.set_state(robot, s);
    for (int link = 0; link < 6; ++link) {
      const MatX J = world.jacobian(robot, link);
      for (int k = 0; k < world.dof(robot); ++k) {
        const VecX unit = VecX::Unit(world.dof(robot), k);
        world.set_state(robot, moved(s, unit, fixed, kStep));
        const Pose ahead = world.link_pose(robot, link);
        world.set_state(robot, moved(s, unit, fixed, -kStep));
        const Pose behind = world.link_pose(robot, link);
        world.set_state(robot, s);
        VecX slope(6);
        const Eigen::AngleAxisd turn(Mat3(ahead.linear() * behind.linear().transpose()));
        slope << (ahead.translation() - behind.translation()), turn.angle() * turn.axis();
        EXPECT_LT((J.col(k) - slope / (2 * kStep)).norm(), 1e-8) << "link " << link << ", coordinate " << k;
      }
    }
  }
}

TEST(Kinematics, TheMassMatrixGivesTheEnergyAndMomentumOfTheLinks) {
  for (const bool fixed : {true, false}) {
    World world;
    const int robot = world.add_robot(kTree, {.fixed_base = fixed});
    const RobotState s = odd_state(world, robot);
    world.set_state(robot, s);
    const Real energy = kinetic_energy(world, robot);
    EXPECT_NEAR(s.v.dot(world.mass_matrix(robot) * s.v) / 2, energy, 1e-13 * energy);
    if (fixed) continue;
    const auto [linear, angular] = momentum(world, robot);
    const VecX p = world.generalized_momentum(robot);
    EXPECT_LT((p.head<3>() - linear).norm(), 1e-13 * linear.norm());
    EXPECT_LT((p.segment<3>(3) + s.X_WB.translation().cross(linear) - angular).norm(), 1e-13 * angular.norm());
  }
}

TEST(Kinematics, TheMassMatrixIsTheInverseOfBulletsArticulatedBodies) {
  for (const bool fixed : {true, false}) {
    World world;
    const int robot = world.add_robot(kTree, {.fixed_base = fixed});
    world.set_state(robot, odd_state(world, robot));
    const VecX rest = world.acceleration(robot, VecX::Zero(world.dof(robot)));
    const MatX M = world.mass_matrix(robot);
    for (int k = 0; k < world.dof(robot); ++k) {
      const VecX unit = VecX::Unit(world.dof(robot), k);
      EXPECT_LT((M * (world.acceleration(robot, unit) - rest) - unit).norm(), 1e-10) << "force " << k;
    }
  }
}

TEST(Kinematics, AStateSetsMimickingJointsByThoseThatTheyMimic) {
  RobotModel model = tree();
  model.joints[4].mimic = Mimic{3, -0.7, 0.2};
  for (const bool fixed : {true, false}) {
    World world;
    const int robot = world.add_robot(std::make_shared<RobotModel>(model), {.fixed_base = fixed});
    const RobotState given = odd_state(world, robot);
    world.set_state(robot, given);
    const RobotState set = world.state(robot);
    EXPECT_NEAR(set.q[4], -0.7 * given.q[3] + 0.2, 1e-15);
    EXPECT_NEAR(set.v.tail(5)[4], -0.7 * given.v.tail(5)[3], 1e-15);
    EXPECT_EQ(set.q.head(4), given.q.head(4));
    EXPECT_LT((set.v.head(world.dof(robot) - 1) - given.v.head(world.dof(robot) - 1)).norm(), 1e-14);
  }
}

TEST(Kinematics, WhatCannotBeSimulatedIsRefusedByName) {
  const auto refused = [](RobotModel model, const RobotParams& params, const std::string& name) {
    World world;
    try {
      world.add_robot(std::make_shared<RobotModel>(std::move(model)), params);
      ADD_FAILURE() << "accepted a bad " << name;
    } catch (const InputError& e) {
      EXPECT_NE(std::string(e.what()).find(name), std::string::npos) << e.what();
    }
  };
  RobotModel model = tree();
  model.links[2].inertial.mass = 0;
  refused(model, {}, "link2: mass = 0");
  model = tree();
  model.links[3].inertial.inertia(0, 0) = -1;
  refused(model, {}, "link3: its inertia");
  model = tree();
  model.joints[1].parent = 4;
  refused(model, {}, "joint1: its parent");
  model = tree();
  model.joints[1].axis *= 2;
  refused(model, {}, "joint1: its axis");
  refused(tree(), {.drives = {{.kp = 1}}}, "1 drive gains for 5 joints");
  refused(tree(), {.drives = std::vector<DriveGains>(5, {.kp = -1})}, "joint0: kp = -1");
  refused(tree(), {.friction = -1}, "friction = -1");
  EXPECT_THROW(World({.substep = 0}), InputError);
  World world;
  world.add_robot(kTree);
  EXPECT_THROW(world.step(0), InputError);
  EXPECT_THROW(world.step(0.01, {VecX::Zero(4)}), InputError);
  EXPECT_THROW(world.command(0, std::vector<JointCommand>(4)), InputError);
  EXPECT_THROW(world.set_state(0, {Pose::Identity(), VecX::Zero(4), VecX::Zero(5)}), InputError);
  EXPECT_THROW(world.restore({{1, 2, 3}}), InputError);
}
