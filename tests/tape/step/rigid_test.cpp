// Motion of rigid bodies and of shells as a whole against closed forms: checks.md traps T2 and T8, part 6.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tape/math/rotation.hpp"
#include "tape/model/primitives.hpp"
#include "tests/support/simulation.hpp"
using namespace tape;
using test::Simulation;

namespace {
constexpr Real kGravity = 9.81;

/// A steel cube that swings about the origin: a pendulum of reduced length 150 mm, w^2 = g/0.15. It hangs in the plane y = 0.
struct Pendulum {
  static constexpr Real kReduced = 0.15, kSide = 0.01;
  Real arm;  // [m] to the centre of mass: arm + k^2/arm = 150 mm, k^2 = side^2/6 for a cube
  Simulation simulation;

  Pendulum(Real angle, Real dt)
      : arm((kReduced + std::sqrt(kReduced * kReduced - 4 * kSide * kSide / 6)) / 2), simulation(setup(arm, angle, dt)) {}
  static tape::Setup setup(Real arm, Real angle, Real dt) {
    tape::Setup setup;
    setup.scene.time.dt = dt;
    setup.newton.velocity_tol = 1e-8;
    const Mat3 R = rotation_exp(Vec3(0, -angle, 0));
    Body& bob = test::add_body(setup, "bob", box_mesh(Vec3::Constant(kSide)), Motion::dynamic, R * Vec3(0, 0, -arm));
    bob.pose.rotation = R;
    bob.density = 7800;
    Grip& pivot = setup.scene.grips.emplace_back();
    pivot.name = "pivot";
    pivot.what = {.object = "bob", .vertices = {}, .points = {Vec3(0, 0, arm)}};
    pivot.stiffness = 1e5;
    return setup;
  }
  /// [m] of the swing of an oscillator with position x and speed v: the same at any phase, and for implicit Euler exactly so.
  Real amplitude() const {
    const BodyState& bob = simulation.state().bodies[0];
    return std::hypot(bob.pose.position.x(), bob.velocity.x() / std::sqrt(kGravity / kReduced));
  }
};
/// Period [s] of a pendulum let go at `angle`: twice the time between two passes of the lowest point.
Real period(Real angle) {
  Pendulum pendulum(angle, 1e-3);
  std::vector<Real> crossing;
  Real last = 1;
  pendulum.simulation.run_to(0.7, [&](const Simulation& s) {
    const Real now = s.state().bodies[0].pose.position.x();
    if (now * last < 0) crossing.push_back(s.state().time - s.report().dt * now / (now - last));
    last = now;
  });
  return crossing.size() == 2 ? 2 * (crossing[1] - crossing[0]) : 0;
}
}  // namespace

TEST(Pendulum, ImplicitEulerDampsItAsItMust) {
  // T2: by (1 + (w dt)^2)^(-1/2) per step. After 10 s 3.84 % is left at dt 0.01 s, 19.5 % at 0.005 s.
  for (const auto& [dt, kept] : {std::pair{0.01, 0.0384}, {0.005, 0.195}}) {
    Pendulum pendulum(0.05, dt);
    const Real start = pendulum.amplitude();
    pendulum.simulation.run_to(10);
    EXPECT_TRUE(pendulum.simulation.broken.empty()) << pendulum.simulation.broken.front();
    RecordProperty("kept at dt " + to_text(dt), to_text(pendulum.amplitude() / start));
    EXPECT_NEAR(pendulum.amplitude() / start, kept, 0.005 * kept) << "at dt " << dt;
  }
}
TEST(Pendulum, SwingsInItsPeriodAndSlowerWhenItSwingsWide) {
  const Real small = 2 * std::numbers::pi * std::sqrt(Pendulum::kReduced / kGravity);
  EXPECT_NEAR(period(0.02), small, 1e-3 * small);
  EXPECT_NEAR(period(std::numbers::pi / 6), 1.01740880 * small, 1e-3 * small);  // checks.md part 6
}

TEST(YoYo, ADrumUnwindsItsStripAtTheClosedFormRate) {
  // A steel drum of r = 20 mm falls and unwinds 1.5 turns that hang from a fixed grip; v = R w at the radius R where the strip leaves.
  // Its energy, m/2 v^2 (1 + I/(m R^2)) = m g h, differentiated with an R that shrinks as the spiral comes off, gives
  //   a = (g + I/(m R^3) dR/dh v^2) / (1 + I/(m R^2)).
  // Left out: the strip, 0.4 % of the drum's mass, what unbending it gives back, 0.03 % of the work of gravity, and that the drum has
  // 96 sides, 0.1 % of its inertia. 1 % covers them.
  const Real r = 0.02, layers[] = {0.02025, 0.020375, 0.0205};  // [m] half circles, each 0.125 mm wider than the one before
  auto setup = test::strip_setup(test::flat_strip(0.242, 2, Vec3(layers[0], 0, 0)));
  Strip& strip = setup.scene.strips[0];
  strip.mesh.cell_length = 0.004;
  strip.pose.rotation = rotation_exp(Vec3(0, std::numbers::pi / 2, 0));
  for (const Real radius : layers) strip.path.push_back({.length = std::numbers::pi * radius, .turn = -std::numbers::pi});
  Body& drum = test::add_body(setup, "drum", cylinder_mesh(r, 0.03, 96, 1), Motion::dynamic, Vec3::Zero());
  drum.pose.rotation = rotation_exp(Vec3(std::numbers::pi / 2, 0, 0));
  drum.density = 7800;
  setup.scene.time.dt = 0.002;
  const StripMesh mesh = make_strip_mesh(strip.mesh, 0.019, 1);
  setup.scene.grips = {test::hold("tie", root_vertices(mesh, 1e-9)), test::hold("hanger", tip_vertices(mesh, 1e-9))};
  setup.scene.grips[0].to = "drum";
  Simulation simulation(setup);

  const Real m = simulation.world().assembly.bodies[0].mass.mass, I = m * r * r / 2;
  struct Fall {
    Real h, v, R;
  };
  const auto fall = [&] {
    const BodyState& body = simulation.state().bodies[0];
    return Fall{-body.pose.position.z(), -body.velocity.z(), -body.velocity.z() * I / body.angular_momentum.norm()};
  };
  simulation.run_to(0.15);  // tight by then, and the outer half turn is off
  const Fall start = fall();
  simulation.run_to(0.23);
  const Fall end = fall();
  EXPECT_TRUE(simulation.broken.empty()) << simulation.broken.front();
  for (const Real R : {start.R, end.R}) {
    EXPECT_GT(R, r + test::vinyl().xi);
    EXPECT_LT(R, layers[2]);
  }
  const Real R = (start.R + end.R) / 2, v = (start.v + end.v) / 2;
  const Real a = (kGravity + I / (m * R * R * R) * (end.R - start.R) / (end.h - start.h) * v * v) / (1 + I / (m * R * R));
  RecordProperty("m/s^2, measured and expected", to_text((end.v - start.v) / 0.08) + ", " + to_text(a));
  EXPECT_NEAR((end.v - start.v) / 0.08, a, 0.01 * a);
}

TEST(Momentum, AFreeStripKeepsItsLinearMomentumAndLosesAngularMomentumWithDt) {
  // T8: implicit Euler loses about (w dt)^2 of the angular momentum in each step of a spinning shell.
  Real last_loss = 1;
  for (const Real dt : {0.002, 0.001, 0.0005}) {
    auto setup = test::strip_setup(test::flat_strip(0.02, 3, Vec3::Zero()));
    setup.scene.gravity.setZero();
    setup.scene.time.dt = dt;
    setup.newton.velocity_tol = 1e-7;
    Simulation simulation(setup);
    const Real rate = 10;
    State& state = simulation.state();
    const Vec3 middle(0.01, 0, 0);
    for (std::size_t v = 0; v < state.x.size(); ++v) state.v[v] = Vec3(0.1, 0, 0) + Vec3(0, 0, rate).cross(state.x[v] - middle);
    Vec3 p0 = Vec3::Zero(), l0 = Vec3::Zero();
    Real mass = 0;
    for (std::size_t v = 0; v < state.x.size(); ++v) {
      const Real m = simulation.world().assembly.mass[v];
      mass += m, p0 += m * state.v[v], l0 += m * (state.x[v] - middle).cross(state.v[v]);
    }
    Real largest = l0.z();
    simulation.run_to(0.05, [&](const Simulation& s) {
      const Vec3 centre = middle + Vec3(0.1, 0, 0) * s.state().time;
      const Real spin = (s.report().angular_momentum - centre.cross(s.report().momentum)).z();
      EXPECT_LT(spin, largest + 1e-12);
      largest = spin;
    });
    EXPECT_LT((simulation.report().momentum - p0).norm(), mass * 1e-7 * simulation.state().step);
    const Real loss = 1 - largest / l0.z();
    EXPECT_LT(loss, 0.6 * last_loss);
    EXPECT_GT(loss, 0.4 * last_loss * (last_loss < 1 ? 1 : 0));
    last_loss = loss;
  }
}
