// Sliding and sticking against closed forms: checks.md trap T6, part 6.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "tape/math/rotation.hpp"
#include "tape/model/primitives.hpp"
#include "tests/support/simulation.hpp"
using namespace tape;
using test::hold;
using test::Simulation;

namespace {
constexpr Real kGravity = 9.81, kSlope = 0.3;

/// A block on an incline of angle kSlope [rad], seen along it: x is down the slope. It settles under the normal part of gravity alone
/// before it is let go: where the normal force is still swinging, the critical mu would not hold. It is flat, because a tall one pitches
/// when it is let go, and at the critical mu nothing takes that speed away again.
Simulation block_on_incline(Real mu, Real dt) {
  const auto tilted = [&](Real angle) {
    tape::Setup setup;
    setup.scene.contact.dhat = 1e-4;
    setup.scene.time.dt = dt;
    setup.newton.velocity_tol = 1e-7;
    setup.scene.materials[0].mu = mu;
    setup.scene.gravity = kGravity * Vec3(std::sin(angle), 0, -std::cos(kSlope));
    test::add_body(setup, "plane", box_mesh(Vec3(0.4, 0.2, 0.01)), Motion::fixed, Vec3(0, 0, -0.005));
    test::add_body(setup, "block", box_mesh(Vec3(0.02, 0.02, 0.002)), Motion::dynamic, Vec3(0, 0, 0.00109));
    return setup;
  };
  Simulation level(tilted(0)), simulation(tilted(kSlope));
  level.run_to(0.5);
  simulation.state().bodies = level.state().bodies;
  return simulation;
}
Real speed(const Simulation& s) { return s.state().bodies[1].velocity.x(); }
}  // namespace

TEST(Incline, ABlockHoldsAtMuEqualTanAndSlidesAtTheClosedFormRateBelow) {
  Simulation holds = block_on_incline(std::tan(kSlope), 0.005);
  holds.run_to(0.6);
  EXPECT_TRUE(holds.broken.empty()) << holds.broken.front();
  EXPECT_LT(speed(holds), 1e-4) << "faster than eps_v";
  for (const EffectReport& e : holds.report().effects) EXPECT_TRUE(e.name != "friction" || e.energy == 0) << "friction stores nothing";
  const Real mu = 0.98 * std::tan(kSlope), a = kGravity * (std::sin(kSlope) - mu * std::cos(kSlope));
  Simulation slides = block_on_incline(mu, 0.005);
  slides.run_to(0.2);
  const Real before = speed(slides);
  slides.run_to(0.6);
  EXPECT_TRUE(slides.broken.empty()) << slides.broken.front();
  EXPECT_NEAR((speed(slides) - before) / 0.4, a, 0.02 * a);
}

TEST(Incline, SlidingDoesNotDependOnTheTimeStep) {
  // T6: friction carries the dt^2 of the barrier. v = a t, and the distance is the sum of implicit Euler, a t (t + dt)/2.
  const Real mu = 0.2, a = kGravity * (std::sin(kSlope) - mu * std::cos(kSlope)), t = 0.3;
  for (const Real dt : {0.01, 0.005, 0.0025}) {
    Simulation s = block_on_incline(mu, dt);
    const Real start = s.state().bodies[1].pose.position.x();
    s.run_to(t);
    EXPECT_TRUE(s.broken.empty()) << s.broken.front();
    const Real way = s.state().bodies[1].pose.position.x() - start;
    EXPECT_NEAR(speed(s), a * t, 0.02 * a * t) << "at dt " << dt;
    EXPECT_NEAR(way, a * t * (t + dt) / 2, 0.02 * way) << "at dt " << dt;
  }
}

TEST(Capstan, AStripDraggedOverADrumPullsBackByTheEulerFactor) {
  // exp(mu phi) at mu 0.3 over 180 degrees: 2.56633 (checks.md part 6).
  auto setup = test::strip_setup(test::flat_strip(0.124, 2, Vec3::Zero()));
  Strip& strip = setup.scene.strips[0];
  const Real R = 0.0203, reach = 0.03;
  strip.mesh.cell_length = 0.002;
  strip.pose = {rotation_exp(Vec3(0, -std::numbers::pi / 2, 0)), Vec3(-R, 0, -reach)};
  strip.path = {{.length = reach, .turn = 0}, {.length = std::numbers::pi * R, .turn = -std::numbers::pi}};
  setup.scene.materials[0].mu = 0.3;
  setup.newton.velocity_tol = 1e-4;
  test::add_body(setup, "drum", cylinder_mesh(0.02, 0.03, 96, 1), Motion::fixed, Vec3::Zero()).pose.rotation =
      rotation_exp(Vec3(std::numbers::pi / 2, 0, 0));
  test::add_body(setup, "weight", box_mesh(Vec3(0.01, 0.02, 0.02)), Motion::dynamic, Vec3(-R, 0, -reach - 0.015)).mass = 0.05;
  const StripMesh mesh = make_strip_mesh(strip.mesh, 0.019, 1);
  setup.scene.grips = {hold("hook", root_vertices(mesh, 1e-9)), hold("pull", tip_vertices(mesh, 1e-9))};
  setup.scene.grips[0].to = "weight";
  setup.scene.grips[1].motion = {{0, 1, Vec3(0, 0, -0.02)}};
  Simulation simulation(setup);
  simulation.check_intersections = false;
  simulation.may_reach_limits = true;  // the first step, in which the weight starts to hang
  simulation.run_to(0.25);
  EXPECT_TRUE(simulation.broken.empty()) << simulation.broken.front();
  const Real ratio = simulation.report().grip_force[1].z() / simulation.report().grip_force[0].z();
  EXPECT_NEAR(ratio, std::exp(0.3 * std::numbers::pi), 0.03 * std::exp(0.3 * std::numbers::pi));
}
