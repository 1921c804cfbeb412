#include <gtest/gtest.h>

#include "tape/model/primitives.hpp"
#include "tests/cosim/exchange/robots.hpp"
using namespace cosim::test;
using cosim::RobotScene;
using robot::Vec3;
using tape::Real;

namespace {
constexpr Real kLink = 0.3;  // [kg]

/// A link whose mass is about its origin, where the wheel turns on it; its hull stands 0.1 m above.
robot::Link holder() {
  robot::Link link = box_link("holder", kLink, Vec3::Constant(0.04));
  link.collision = {robot::box_shape(Vec3::Constant(0.04), robot::Pose(Eigen::Translation3d(0, 0, 0.1)))};
  return link;
}
/// A wheel about y at the origin, on an axle to the link.
tape::Setup wheel(const std::string& link, const Vec3& gravity, Real torque) {
  tape::Setup s;
  s.scene.gravity = gravity;
  s.scene.time.dt = 0.005;
  s.newton.velocity_tol = 1e-9;
  tape::Body& body = tape::test::add_body(s, "wheel", tape::cylinder_mesh(0.03, 0.02, 24, 1), tape::Motion::dynamic, Vec3::Zero());
  body.pose.rotation << 1, 0, 0, 0, 0, 1, 0, -1, 0;  // its z along y
  body.density = 2000;
  s.scene.axles = {{.body = "wheel", .to = link, .params = {.torque = torque}}};
  return s;
}
Real wheel_mass(const Coupled& both) { return both.world->assembly.bodies[0].mass.mass; }
}  // namespace

TEST(AxleToLink, TheLinkCarriesTheWeightOfTheWheel) {
  RobotModel model{.name = "mast"};
  model.links = {{.name = "foot"}, holder()};
  model.joints = {joint("lift", robot::JointType::prismatic, Vec3::UnitZ(), Vec3::Zero())};
  RobotScene scene;
  scene.robots = {part("mast", model, Vec3::Zero())};
  scene.robots[0].params.drives = {{.kp = 2e4, .kd = 200}};
  scene.robots[0].motions = {stand("lift", 0)};
  Coupled both(wheel("mast:holder", Vec3(0, 0, -9.81), 0), scene);
  Real carried = 0;
  for (int k = 0; k < 200; ++k) {
    ASSERT_TRUE(both.step()) << both.report.failure;
    if (k >= 100) carried += both.link(0, 0).hold.force.z() / 100;
  }
  const Real weight = wheel_mass(both) * 9.81;
  EXPECT_NEAR(carried, -weight, 1e-3 * weight);
  EXPECT_NEAR(both.bullet().state(0).q[0], -(weight + kLink * 9.81) / 2e4, 1e-5);
  EXPECT_LT((both.state.bodies[0].pose.position - both.bullet().link_pose(0, 1).translation()).norm(), 1e-4) << "they go together";
}

/// A holder that flies takes the wheel along: their momentum stays, and without friction the wheel does not begin to turn.
TEST(AxleToLink, AFloatingLinkAndItsWheelKeepTheirMomentum) {
  RobotModel model{.name = "kite"};
  model.links = {holder()};
  RobotScene scene;
  scene.world.gravity.setZero();
  scene.robots = {part("kite", model, Vec3::Zero(), false)};
  scene.robots[0].velocity = Vec3(0.2, 0.1, 0);
  Coupled both(wheel("kite:holder", Vec3::Zero(), 0), scene);
  const Vec3 before = kLink * Vec3(0.2, 0.1, 0);
  for (int k = 0; k < 100; ++k) {
    ASSERT_TRUE(both.step()) << both.report.failure;
    const Vec3 now = both.report.momentum + both.bullet().generalized_momentum(0).head<3>();
    ASSERT_LT((now - before).norm(), 1e-8 * before.norm()) << k;
  }
  EXPECT_LT((both.report.momentum - wheel_mass(both) / (kLink + wheel_mass(both)) * before).norm(), 0.05 * before.norm());
  EXPECT_LT(both.state.bodies[0].angular_momentum.norm(), 1e-8);
}
