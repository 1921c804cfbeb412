// The project's props in the world.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "robot/model/primitives.hpp"
#include "tests/robot/support/own_robots.hpp"
#include "tests/robot/world/driving.hpp"
using namespace robot;
using namespace robot::test;

namespace {
using Model = std::shared_ptr<const RobotModel>;
constexpr Real kCrease = 0.01401;  // [N m/rad] of data/props/README.md
constexpr Real kDegree = std::numbers::pi / 180;

Model ground() {
  RobotModel model{.name = "ground"};
  model.links = {{.name = "ground", .collision = {box_shape({4, 4, 0.1}, Pose(Eigen::Translation3d(0, 0, -0.05)))}}};
  return std::make_shared<RobotModel>(model);
}

/// The carton after its flaps were let go: back and front from 70 degrees (half closed), right and left from as much outside.
VecX sprung_back(const Model& carton) {
  World world;
  const int robot = world.add_robot(carton, {.drives = std::vector<DriveGains>(4, {.kp = kCrease})});
  VecX q(4);
  for (const char* name : {"hinge_back", "hinge_front"}) q[carton->find_joint(name)] = 70 * kDegree;
  for (const char* name : {"hinge_right", "hinge_left"}) q[carton->find_joint(name)] = -70 * kDegree;
  world.set_state(robot, {Pose::Identity(), q, VecX::Zero(4)});
  world.command(robot, hold(VecX::Zero(4)));
  for (int i = 0; i < 400; ++i) world.step(0.01);
  EXPECT_LT(world.state(robot).v.norm(), 1e-4);
  return world.state(robot).q;
}
}  // namespace

TEST(OwnProps, EachStandsWhereItIsPutAndThoseOnAFootAlsoByTheirWeight) {
  for (const std::string name : {"table", "stand", "carton", "dispenser", "presser", "swivel", "knife"}) {
    const Model prop = std::make_shared<RobotModel>(own_prop(name));
    const bool on_a_foot = name == "stand" || name == "carton" || name == "dispenser";
    const Pose X_WB(Eigen::Translation3d(0, 0, name == "table" ? 0.04 : 0.));  // its frame is on its upper surface
    for (const bool fixed : {true, false}) {
      if (!fixed && !on_a_foot && name != "table") continue;
      World world;
      world.add_robot(ground());
      const int robot = world.add_robot(prop, {.X_WB = X_WB, .fixed_base = fixed});
      for (int i = 0; i < 50; ++i) world.step(0.01);
      const Pose X = world.state(robot).X_WB;
      EXPECT_LT((X.translation() - X_WB.translation()).norm(), fixed ? 1e-15 : 3e-4) << name;
      EXPECT_GT(X.linear()(2, 2), fixed ? 1 - 1e-15 : 1 - 1e-5) << name;
    }
  }
}

TEST(OwnCarton, AFlapSpringsBackToSixtyDegreesOnEitherSideWhereCreaseAndWeightBalance) {
  RobotModel model = own_prop("carton");
  for (Joint& joint : model.joints) joint.friction = 0;
  const Model carton = std::make_shared<RobotModel>(model);
  const VecX q = sprung_back(carton);  // k a = (m g L/2) sin a at a = 60 degrees
  for (int k = 0; k < 4; ++k) EXPECT_NEAR(std::abs(q[k]), 60 * kDegree, 0.05 * kDegree) << carton->joints[static_cast<std::size_t>(k)].name;
}

TEST(OwnCarton, WithItsDryFrictionAFlapStopsOnItsWayThereAsSoonAsFrictionHoldsIt) {
  const Model carton = std::make_shared<RobotModel>(own_prop("carton"));
  const VecX q = sprung_back(carton);
  const Real weight = 0.02249 * 9.81 * 0.0768;  // [N m] m g L/2
  for (int k = 0; k < 4; ++k) {
    const Real a = std::abs(q[k]);
    EXPECT_LT(a, 69 * kDegree);
    EXPECT_GT(a, 60 * kDegree);
    EXPECT_LE(std::abs(kCrease * a - weight * std::sin(a)), 1.001 * carton->joints[static_cast<std::size_t>(k)].friction);
  }
}

TEST(OwnDispenser, ItsWheelSpinsFreelyAndSlowsDownByFrictionAndDampingAlone) {
  const Model dispenser = std::make_shared<RobotModel>(own_prop("dispenser"));
  const int wheel = dispenser->find_joint("wheel_axle");
  World world;
  const int robot = world.add_robot(dispenser);
  RobotState state = world.state(robot);
  constexpr Real kSpeed = 12;  // [rad/s]
  state.v[wheel] = kSpeed;
  world.set_state(robot, state);
  for (int i = 0; i < 20; ++i) world.step(0.01);
  const Joint& axle = dispenser->joints[static_cast<std::size_t>(wheel)];
  const Inertial& body = dispenser->links[static_cast<std::size_t>(wheel) + 1].inertial;
  const Real inertia = body.inertia(1, 1) + body.mass * (body.com.x() * body.com.x() + body.com.z() * body.com.z());
  // I dw/dt = -friction - damping w
  const Real still = axle.friction / axle.damping, expected = (kSpeed + still) * std::exp(-axle.damping / inertia * 0.2) - still;
  EXPECT_LT(expected, kSpeed - 1);
  EXPECT_NEAR(world.state(robot).v[wheel], expected, 1e-3 * kSpeed);
  EXPECT_TRUE(world.contacts().empty());
}
