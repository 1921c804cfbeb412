#include <gtest/gtest.h>

#include <cmath>

#include "tests/cosim/exchange/robots.hpp"
using namespace cosim::test;
using cosim::RobotPart;
using cosim::RobotScene;
using robot::JointType;
using robot::Vec3;
using tape::Real;

/// What holds a link in Bullet, where the tape does not see it, bears what the tape exerts on the link at once.
namespace {
constexpr Real kDt = 0.01;
/// A block on a slide, or with a free base, or fixed.
RobotPart block(const std::string& name, double mass, const Vec3& size, const Vec3& at, const Vec3& axis, bool fixed_base = true) {
  RobotModel model{.name = name};
  if (axis.isZero(0)) {
    model.links = {box_link("block", mass, size)};
    return part(name, model, at, fixed_base);
  }
  model.links = {{.name = "rail"}, box_link("block", mass, size)};
  model.joints = {joint("slide", JointType::prismatic, axis, Vec3::Zero())};
  return part(name, model, at);
}
/// A ram that pushes with 5 N downwards on a strip in space, below which there is a plate; what holds the plate is not near the strip.
struct Press {
  std::unique_ptr<Coupled> both;
  RobotScene scene;
  Press(double mass, const RobotPart& plate, const std::vector<RobotPart>& holding, double x = 0, double gravity = 0) {
    scene.world.gravity = Vec3(0, 0, -gravity);
    scene.robots = {block("ram", 2 * mass, Vec3(0.012, 0.012, 0.01), Vec3(x, 0, 0.0056), -Vec3::UnitZ()), plate};
    scene.robots[0].push = {5};
    scene.robots.insert(scene.robots.end(), holding.begin(), holding.end());
    tape::Setup s = tape::test::strip_setup(tape::test::flat_strip(0.06, 3, Vec3(-0.03, 0, 0)));
    s.scene.gravity.setZero();
    s.scene.time.dt = kDt;
    s.newton.velocity_tol = 1e-4;
    both = std::make_unique<Coupled>(s, scene);
  }
  void step() { ASSERT_TRUE(both->step()) << both->report.failure; }
  Real force() const { return both->link(0, 0).normal.force.z(); }
};
const Vec3 kPlate(0.03, 0.03, 0.01), kPlateAt(0, 0, -0.0056), kBelow(0, 0, -0.0156);
RobotPart sliding_plate(double mass) { return block("plate", mass, kPlate, kPlateAt, Vec3::UnitZ()); }
/// Holds the plate by friction of 0.5 times its push, at its side.
RobotPart jaw(double push) {
  RobotPart out = block("jaw", 0.05, Vec3(0.01, 0.03, 0.004), Vec3(0.0201, 0, -0.0086), -Vec3::UnitX());
  out.push = {push};
  return out;
}
}  // namespace

/// The ram bounces against the held strip; the velocity that is left changes its sign and falls by (N - 1)/(N + 1) in a step of N = 10
/// substeps (exchange/README), and so does what the force is off by.
TEST(BulletContacts, ABlockBelowBearsThePress) {
  Press press(0.02, sliding_plate(0.02), {block("block", 1, kPlate, kBelow, Vec3::Zero())});
  Real mean = 0, first = 0;
  for (int k = 0; k < 30; ++k) {
    press.step();
    if (k == 9) first = std::fabs(press.force() - 5);
    if (k >= 10) mean += press.force() / 20;
  }
  EXPECT_NEAR(mean, 5, 0.01 * 5);
  EXPECT_NEAR(press.force(), 5, 1.2 * std::pow(9.0 / 11, 20) * first);
  EXPECT_LT(press.both->report.link_mismatch, 1e-6);
}
TEST(BulletContacts, ABlockBelowBearsAPressBesideTheMiddle) {
  const Vec3 none = Vec3::Zero();
  Press press(0.02, block("plate", 0.2, kPlate, kPlateAt, none, false), {block("block", 1, kPlate, kBelow, none)}, 0.006, 9.81);
  for (int k = 0; k < 30; ++k) press.step();
  EXPECT_NEAR(press.force(), 5 + 0.04 * 9.81, 0.02 * 5);
  EXPECT_LT(press.both->report.link_mismatch, 2e-5);
  EXPECT_NEAR(press.both->bullet().link_pose(1, 0).linear()(2, 2), 1, 1e-6) << "it does not tilt";
}
TEST(BulletContacts, FrictionOfAJawBearsThePress) {
  Press press(0.02, sliding_plate(0.02), {jaw(20)});
  for (int k = 0; k < 30; ++k) press.step();
  EXPECT_NEAR(press.force(), 5, 0.02 * 5);
  EXPECT_LT(press.both->report.link_mismatch, 1e-5);
}
/// Friction of 3 N on a plate of 10 kg gives way to a ram of 20 kg: they move on together by (5 - 3)/30 m/s^2.
TEST(BulletContacts, FrictionThatIsOvercomeGoesOnBraking) {
  Press press(10, sliding_plate(10), {jaw(6)});
  Real mean = 0, speed = 0;
  for (int k = 0; k < 40; ++k) {
    press.step();
    if (k == 19) speed = press.both->bullet().state(1).v[0];
    if (k >= 20) mean += press.force() / 20;
  }
  EXPECT_NEAR(mean, 3 + 2.0 / 3, 0.02 * 3);
  EXPECT_NEAR(press.both->bullet().state(1).v[0] - speed, -0.2 * 2 / 30, 0.05 * 0.2 * 2 / 30);
}
/// A second plate that is free to move gives way by its mass: ram, plate and it, 2 : 1 : 1, are driven on together by 5 N.
TEST(BulletContacts, AnotherRobotGivesWayByItsMass) {
  Press press(1, sliding_plate(1), {block("second", 1, kPlate, kBelow, Vec3::UnitZ())});
  Real mean = 0;
  for (int k = 0; k < 30; ++k) {
    press.step();
    if (k >= 10) mean += press.force() / 20;
  }
  EXPECT_NEAR(mean, 5 * 2.0 / 4, 0.02 * 2.5);
  EXPECT_NEAR(press.both->bullet().state(2).v[0], -0.3 * 5 / 4, 0.05 * 0.3 * 5 / 4);
}
