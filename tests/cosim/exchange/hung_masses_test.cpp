#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/cosim/exchange/robots.hpp"
using namespace cosim::test;
using cosim::RobotScene;
using robot::Vec3;
using tape::Real;

namespace {
constexpr Real kLength = 0.1, kLift = 0.05;  // [m]

/// A cube hung on a strip that is held at its upper end, or that a driven hook holds there.
struct Hung {
  Coupled both;
  static RobotScene weight(Real mass) {
    RobotModel model{.name = "weight"};
    model.links = {box_link("cube", mass, Vec3::Constant(0.02))};
    RobotScene scene;
    scene.robots = {part("weight", model, Vec3(0, 0, -kLength - 0.011), false)};
    return scene;
  }
  /// Beside it a hook of 1 kg on a slide, which goes up by kLift in half a second.
  static RobotScene weight_and_hook(Real mass) {
    RobotModel model{.name = "lift"};
    model.links = {{.name = "rail"}, box_link("hook", 1, Vec3::Constant(0.01), Vec3(0, 0, 0.1))};
    model.joints = {joint("slide", robot::JointType::prismatic, Vec3::UnitZ(), Vec3::Zero())};
    RobotScene scene = weight(mass);
    scene.robots.push_back(part("lift", model, Vec3::Zero()));
    scene.robots[1].params.drives = {{.kp = 1e5, .kd = 2e3}};
    scene.robots[1].motions = {{[](const robot::VecX&) {
                                  return robot::JointTrajectory{
                                      .joints = {"slide"},
                                      .times = {0, 0.1, 0.6},
                                      .knots = {robot::VecX::Zero(1), robot::VecX::Zero(1), robot::VecX::Constant(1, kLift)}};
                                },
                                0, 0.6}};
    return scene;
  }
  static tape::Setup strip(Real dt) {
    tape::Strip hanging = tape::test::flat_strip(kLength, 3, Vec3::Zero());
    hanging.pose.rotation << 0, 0, 1, 0, 1, 0, -1, 0, 0;  // x goes down
    tape::Setup s = tape::test::strip_setup(hanging);
    s.scene.time.dt = dt;
    const int last = static_cast<int>(tape::World::build(s).assembly.x.size());
    s.scene.grips = {tape::test::hold("top", {0, 1, 2, 3}), tape::test::hold("tie", {last - 4, last - 3, last - 2, last - 1})};
    s.scene.grips[1].to = "weight:cube";
    return s;
  }
  static tape::Setup hooked_strip(Real dt) {
    tape::Setup s = strip(dt);
    s.scene.grips[0].to = "lift:hook";
    return s;
  }
  Hung(Real mass, Real dt) : both(strip(dt), weight(mass)) {}
  Hung(const RobotScene& robots, const tape::Setup& setup) : both(setup, robots) {}
  Real height(int robot = 0, int link = 0) const { return both.bullet().link_pose(robot, link).translation().z(); }
};

/// Strain of a St. Venant-Kirchhoff strip under a load [1] of E A: the root of (1 + e) ((1 + e)^2 - 1) / 2 = load.
Real strain_under(Real load) {
  Real e = load;
  for (int k = 0; k < 50; ++k) e -= ((1 + e) * (2 * e + e * e) / 2 - load) / (1 + 3 * e + 1.5 * e * e);
  return e;
}
/// [m] by which the weight of a mass stretches the strip.
Real stretch_under(Real mass) {
  const tape::Film film = tape::test::vinyl();
  return kLength * strain_under(mass * 9.81 / (film.membrane_modulus * film.width * film.thickness));
}

/// A hook draws a mass up by the strip between them: it never diverges, and comes to hang below the hook by the strip's stretch.
void lift(Real mass, Real dt) {
  SCOPED_TRACE(std::to_string(mass) + " kg, " + std::to_string(dt) + " s");
  Hung lifted(Hung::weight_and_hook(mass), Hung::hooked_strip(dt));
  const Real before = lifted.height(), hook_before = lifted.height(1, 1);
  Real pull = 0, place = 0, highest = 0;
  int steps = 0;
  while (lifted.both.state.time < 3) {
    ASSERT_TRUE(lifted.both.step()) << lifted.both.report.failure;
    const Real risen = lifted.height() - before, hook = lifted.height(1, 1) - hook_before;
    highest = std::max(highest, risen);
    if (lifted.both.state.time < 2) continue;
    pull += lifted.both.link(0, 0).hold.force.z(), place += risen - hook, ++steps;
  }
  EXPECT_NEAR(pull / steps, mass * 9.81, 0.05 * mass * 9.81);
  EXPECT_NEAR(place / steps, -stretch_under(mass), 0.05 * stretch_under(mass) + 2e-5);
  EXPECT_LT(highest, 1.5 * kLift);
}
}  // namespace

/// From rest with a slack strip to rest, lower by m g L / (E A) where that is small; 10 kg stretch it by a third. At time steps far beyond
/// 2 sqrt(m/k) (1.5 ms for 1 g).
TEST(HungMasses, RestWhereTheStripCarriesThemAtAnyStep) {
  for (const Real mass : {0.001, 0.03, 0.3, 10.0}) {
    for (const Real dt : {1.0 / 30, 0.01}) {
      Hung hung(mass, dt);
      const Real before = hung.height();
      Real pull = 0, place = 0, lowest = 0;
      int steps = 0;
      while (hung.both.state.time < 3) {
        ASSERT_TRUE(hung.both.step()) << mass << " kg, " << dt << " s: " << hung.both.report.failure;
        lowest = std::min(lowest, hung.height() - before);
        if (hung.both.state.time < 2) continue;
        pull += hung.both.link(0, 0).hold.force.z(), place += hung.height() - before, ++steps;
      }
      const Real stretch = stretch_under(mass);
      EXPECT_NEAR(pull / steps, mass * 9.81, 0.05 * mass * 9.81) << mass << " kg, " << dt << " s";
      EXPECT_NEAR(place / steps, -stretch, 0.05 * stretch + 2e-5) << mass << " kg, " << dt << " s";
      EXPECT_GT(lowest, -2.2 * stretch - 5e-5) << "a weight that is let go falls twice its stretch";
    }
  }
}
TEST(HungMasses, FollowTheirDriveThroughTheStripAtAnyStep) {
  for (const Real mass : {0.001, 0.3, 10.0})
    for (const Real dt : {1.0 / 30, 0.01}) lift(mass, dt);
}
TEST(LongHungMasses, FollowTheirDriveInStepsOfAMillisecondToo) {
  for (const Real mass : {0.001, 0.3, 10.0}) lift(mass, 0.001);
}
