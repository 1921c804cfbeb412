#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tape/bodies/free_flight.hpp"
#include "tape/math/rotation.hpp"
#include "tape/model/primitives.hpp"
#include "tests/support/simulation.hpp"
using namespace tape;
using test::Simulation;

namespace {
constexpr Real kRadius = 0.03, kHeight = 0.02, kDensity = 2000;
/// A polygon of n corners has not quite the inertia of the disc: that of the mesh counts.
Real inertia(const Simulation& s, std::size_t body = 0) { return inertia_tensor(s.world().assembly.bodies[body].mass.second)(2, 2); }
/// A wheel on an axle through its centre, along its z, which stands askew in the world.
tape::Setup wheel(const AxleParams& axle) {
  tape::Setup setup;
  setup.scene.time.dt = 0.01;
  setup.newton.velocity_tol = 1e-8;
  Body& body = test::add_body(setup, "wheel", cylinder_mesh(kRadius, kHeight, 48, 1), Motion::dynamic, Vec3(0.1, 0.2, 0.3));
  body.pose.rotation = rotation_exp(Vec3(0.4, -0.7, 0.2));
  body.density = kDensity;
  setup.scene.axles = {{.body = "wheel", .to = "", .params = axle}};
  return setup;
}
/// [rad/s] about its own z.
Real spin(const Simulation& s, std::size_t body = 0) {
  const BodyState& b = s.state().bodies[body];
  return b.angular_momentum.dot(b.pose.rotation.col(2)) / inertia(s, body);
}
}  // namespace

TEST(Axle, APendulumOnItSwingsInItsPeriod) {
  // A cube whose centre hangs 45 mm below the axle: T = 2 pi sqrt((side^2/6 + arm^2)/(g arm)).
  constexpr Real kSide = 0.02, kArm = 0.045;
  tape::Setup setup;
  setup.scene.time.dt = 1e-3;
  setup.newton.velocity_tol = 1e-8;
  const Mat3 R = rotation_exp(Vec3(0, -0.02, 0));
  Body& bob = test::add_body(setup, "bob", box_mesh(Vec3::Constant(kSide)), Motion::dynamic, R * Vec3(0, 0, -kArm));
  bob.pose.rotation = R;
  setup.scene.axles = {{.body = "bob", .to = "", .point = Vec3(0, 0, kArm), .axis = Vec3::UnitY(), .params = {}}};
  Simulation simulation(setup);
  std::vector<Real> crossing;
  Real last = 1;
  simulation.run_to(0.5, [&](const Simulation& s) {
    const Real now = s.state().bodies[0].pose.position.x();
    if (now * last < 0) crossing.push_back(s.state().time - s.report().dt * now / (now - last));
    last = now;
    EXPECT_LT(std::fabs(s.state().bodies[0].pose.position.y()), 1e-7) << "the axle keeps its plane";
  });
  EXPECT_TRUE(simulation.broken.empty()) << simulation.broken.front();
  ASSERT_EQ(crossing.size(), 2u);
  const Real period = 2 * std::numbers::pi * std::sqrt((kSide * kSide / 6 + kArm * kArm) / (9.81 * kArm));
  EXPECT_NEAR(2 * (crossing[1] - crossing[0]), period, 1e-3 * period);
}

TEST(Axle, FrictionStopsAWheelAfterTheAngleThatItsEnergyBuys) {
  constexpr Real kTorque = 1e-4, kSpeed = 10;
  tape::Setup setup = wheel({.torque = kTorque});
  setup.scene.bodies[0].angular_velocity = kSpeed * setup.scene.bodies[0].pose.rotation.col(2);
  Simulation simulation(setup);
  const Real time = inertia(simulation) * kSpeed / kTorque;
  ASSERT_GT(time, 1);
  Real turned = 0, work = 0;
  const Vec3 centre = setup.scene.bodies[0].pose.position;
  simulation.run_to(time - 0.05, [&](const Simulation& s) {
    turned += spin(s) * s.report().dt;
    work += s.report().axle_work;
    EXPECT_NEAR(s.report().axle_torque[0], -kTorque, 1e-6 * kTorque);
    EXPECT_NEAR(spin(s), kSpeed * (1 - s.state().time / time), 1e-4 * kSpeed);
  });
  // A step that turns by a changes the angular momentum as sin(a): speed and angle differ by a^2/6 at most.
  const Real most = kSpeed * setup.scene.time.dt;
  EXPECT_NEAR(work, -kTorque * turned, most * most / 6 * kTorque * turned);
  simulation.run_to(time + 0.5);
  EXPECT_TRUE(simulation.broken.empty()) << simulation.broken.front();
  EXPECT_LT(std::fabs(spin(simulation)), 1e-2) << "it creeps at most";
  EXPECT_LT((simulation.state().bodies[0].pose.position - centre).norm(), 2e-5) << "ten micrometres under its own weight";
}

TEST(Axle, ADriveTakesAWheelToItsSpeedWithNoMoreThanItsTorque) {
  constexpr Real kTorque = 2e-4, kSpeed = -30;
  Simulation simulation(wheel({.torque = kTorque, .speed = kSpeed}));
  const Real time = inertia(simulation) * std::fabs(kSpeed) / kTorque;
  simulation.run_to(time / 2, [&](const Simulation& s) { EXPECT_NEAR(s.report().axle_torque[0], -kTorque, 1e-6 * kTorque); });
  EXPECT_NEAR(spin(simulation), kSpeed / 2, 1e-2 * std::fabs(kSpeed));
  simulation.run_to(1.5 * time);
  EXPECT_TRUE(simulation.broken.empty()) << simulation.broken.front();
  EXPECT_NEAR(spin(simulation), kSpeed, 1e-3 * std::fabs(kSpeed));
  EXPECT_LT(std::fabs(simulation.report().axle_torque[0]), 1e-3 * kTorque) << "nothing brakes it";
}

TEST(Axle, BetweenTwoBodiesKeepsTheirAngularMomentum) {
  constexpr Real kSpeed = 20;
  tape::Setup setup = wheel({.torque = 2e-4});
  setup.scene.gravity.setZero();
  setup.scene.bodies[0].pose = {};
  setup.scene.bodies[0].angular_velocity = Vec3(0, 0, kSpeed);
  Body& frame = test::add_body(setup, "frame", ring_mesh(0.04, 0.06, kHeight, 48, 1), Motion::dynamic, Vec3::Zero());
  frame.density = kDensity;
  setup.scene.axles[0].to = "frame";
  Simulation simulation(setup);
  const Real of_wheel = inertia(simulation, 0), of_frame = inertia(simulation, 1), together = of_wheel + of_frame;
  const Real time = kSpeed * of_wheel * of_frame / together / 2e-4;
  simulation.run_to(time + 0.1, [&](const Simulation& s) {
    EXPECT_NEAR(s.report().angular_momentum.z(), of_wheel * kSpeed, 1e-7 * of_wheel * kSpeed);
    EXPECT_LT(s.report().momentum.norm(), 1e-10);
  });
  EXPECT_TRUE(simulation.broken.empty()) << simulation.broken.front();
  for (std::size_t body : {0u, 1u}) EXPECT_NEAR(spin(simulation, body), kSpeed * of_wheel / together, 1e-2);
}
