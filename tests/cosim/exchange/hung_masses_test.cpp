#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/cosim/exchange/robots.hpp"
using namespace cosim::test;
using cosim::RobotScene;
using robot::Vec3;
using tape::Real;

namespace {
constexpr Real kLength = 0.1;  // [m]

/// A cube hung on a strip that is held at its upper end.
struct Hung {
  Coupled both;
  static RobotScene weight(Real mass, cosim::Schedule schedule) {
    RobotModel model{.name = "weight"};
    model.links = {box_link("cube", mass, Vec3::Constant(0.02))};
    RobotScene scene;
    scene.exchange.schedule = schedule;
    scene.robots = {part("weight", model, Vec3(0, 0, -kLength - 0.011), false)};
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
  Hung(Real mass, Real dt, cosim::Schedule schedule) : both(strip(dt), weight(mass, schedule)) {}
  Real height() const { return both.bullet().link_pose(0, 0).translation().z(); }
};
}  // namespace

/// Strain of a St. Venant-Kirchhoff strip under a load [1] of E A: the root of (1 + e) ((1 + e)^2 - 1) / 2 = load.
Real strain_under(Real load) {
  Real e = load;
  for (int k = 0; k < 50; ++k) e -= ((1 + e) * (2 * e + e * e) / 2 - load) / (1 + 3 * e + 1.5 * e * e);
  return e;
}

/// From rest with a slack strip to rest, lower by m g L / (E A) where that is small; 10 kg stretch it by a third. At time steps far beyond
/// 2 sqrt(m/k) (1.5 ms for 1 g).
TEST(HungMasses, RestWhereTheStripCarriesThemAtAnyStep) {
  const tape::Film film = tape::test::vinyl();
  const Real stiffness = film.membrane_modulus * film.width * film.thickness / kLength;
  for (const Real mass : {0.001, 0.03, 0.3, 10.0}) {
    for (const Real dt : {1.0 / 30, 0.01}) {
      Hung hung(mass, dt, cosim::Schedule::inertial);
      const Real before = hung.height();
      Real pull = 0, place = 0, lowest = 0;
      int steps = 0;
      while (hung.both.state.time < 3) {
        ASSERT_TRUE(hung.both.step()) << mass << " kg, " << dt << " s: " << hung.both.report.failure;
        lowest = std::min(lowest, hung.height() - before);
        if (hung.both.state.time < 2) continue;
        pull += hung.both.link(0, 0).hold.force.z(), place += hung.height() - before, ++steps;
      }
      const Real stretch = kLength * strain_under(mass * 9.81 / (stiffness * kLength));
      EXPECT_NEAR(pull / steps, mass * 9.81, 0.05 * mass * 9.81) << mass << " kg, " << dt << " s";
      EXPECT_NEAR(place / steps, -stretch, 0.05 * stretch + 2e-5) << mass << " kg, " << dt << " s";
      EXPECT_GT(lowest, -2.2 * stretch - 5e-5) << "a weight that is let go falls twice its stretch";
    }
  }
}
