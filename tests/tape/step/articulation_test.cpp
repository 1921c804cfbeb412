#include "tape/bodies/articulation.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tape/core/error.hpp"
#include "tape/model/primitives.hpp"
#include "tests/support/simulation.hpp"
using namespace tape;

namespace {
using Eigen::MatrixXd;
using Eigen::VectorXd;
constexpr Real kMass = 0.004, kSide = 0.01;  // [kg], [m]
constexpr Real kInertia = kMass * kSide * kSide / 6;

/// A free cube as an articulation of six coordinates that somebody else moves on with its last velocity.
struct Cube {
  Vec3 v = Vec3::Zero(), w = Vec3::Zero();
  Real mass = kMass, inertia = kInertia;
  ArticulationStep step(Real dt) const {
    ArticulationStep s{VectorXd(6), MatrixXd::Zero(6, 6), {MatrixXd::Identity(6, 6)}};
    s.predicted << dt * v, dt * w;
    s.inertia.diagonal() << mass, mass, mass, inertia, inertia, inertia;
    return s;
  }
  void take(const ArticulationReport& r, Real dt) { v = r.q.head<3>() / dt, w = r.q.tail<3>() / dt; }
};

/// A free strip in space with a cube above its middle.
Setup strip_and_cube(Motion motion, Real tolerance) {
  Setup s = test::strip_setup(test::flat_strip(0.06, 3, Vec3(-0.03, 0, 0)));
  s.scene.gravity.setZero();
  s.scene.time.dt = 0.002;
  s.newton.velocity_tol = tolerance;
  Body& cube = test::add_body(s, "cube", box_mesh(Vec3::Constant(kSide)), motion, Vec3(0.002, 0.001, 0.0055));
  cube.mass = kMass;
  if (motion == Motion::linked) s.scene.articulations = {{"free", {"cube"}, 6}};
  return s;
}
Vec3 place(const test::Simulation& s) { return s.state().bodies[0].pose.position; }
}  // namespace

TEST(Articulation, ALinkWithTheInertiaOfACubeMovesLikeTheCube) {
  tape::Setup free = strip_and_cube(Motion::dynamic, 1e-7);
  free.scene.bodies[0].velocity = Vec3(0, 0, -0.3);
  test::Simulation cube(free), link(strip_and_cube(Motion::linked, 1e-7));
  Cube outside{.v = Vec3(0, 0, -0.3)};
  for (int k = 0; k < 15; ++k) {
    cube.step();
    link.exchange.articulations = {outside.step(0.002)};
    const StepReport& report = link.step();
    outside.take(report.articulations[0], 0.002);
    // The cube turns by 0.05 rad; its inertia knows the second order of that, the link's does not.
    ASSERT_LT((place(cube) - place(link)).norm(), 2e-6) << k;
  }
  EXPECT_TRUE(cube.broken.empty() && link.broken.empty());
  EXPECT_GT(outside.v.z(), -0.29);  // the strip has a sixteenth of its mass
  EXPECT_GT(outside.w.norm(), 0.1);
}
TEST(Articulation, LinksAndTapeKeepMomentum) {
  test::Simulation s(strip_and_cube(Motion::linked, 1e-9));
  Cube outside{.v = Vec3(0.05, 0, -0.3)};
  const Vec3 before = kMass * outside.v;
  const Real scale = before.norm();
  for (int k = 0; k < 15; ++k) {
    s.exchange.articulations = {outside.step(0.002)};
    const VectorXd predicted = s.exchange.articulations[0].predicted;
    const ArticulationReport& r = s.step().articulations[0];
    const LinkReport& link = r.links[0];
    const Vec3 force = link.normal.force + link.friction.force;
    EXPECT_LT((force - r.force.head<3>()).norm(), 1e-12 * (1 + force.norm()));
    EXPECT_LT((r.force.head<3>() - kMass * (r.q - predicted).head<3>() / (0.002 * 0.002)).norm(), 1e-9 * scale / 0.002) << k;
    outside.take(r, 0.002);
    EXPECT_LT((s.report().momentum + kMass * outside.v - before).norm(), 1e-9 * scale) << k;
  }
  EXPECT_TRUE(s.broken.empty());
  EXPECT_GT(s.report().momentum.norm(), 0.05 * scale);
}
TEST(Articulation, AnInfinitelyHeavyLinkGivesTheKinematicAnswer) {
  tape::Setup driven = strip_and_cube(Motion::driven, 1e-7);
  driven.scene.bodies[0].velocity = Vec3(0, 0, -0.3);
  test::Simulation moved(driven), link(strip_and_cube(Motion::linked, 1e-7));
  const Cube outside{.v = Vec3(0, 0, -0.3), .w = Vec3::Zero(), .mass = 1e9, .inertia = 1e9};
  for (int k = 0; k < 15; ++k) {
    moved.step();
    link.exchange.articulations = {outside.step(0.002)};
    link.step();
    for (std::size_t v = 0; v < moved.state().x.size(); ++v) ASSERT_LT((moved.state().x[v] - link.state().x[v]).norm(), 1e-8) << k;
  }
  EXPECT_TRUE(moved.broken.empty() && link.broken.empty());
}
TEST(Articulation, AHingedLinkTurnsAboutItsHinge) {
  tape::Setup hinged = strip_and_cube(Motion::linked, 1e-9);
  hinged.scene.articulations[0].coordinates = 3;
  test::Simulation s(hinged);
  // One coordinate: a turn about y through a hinge 30 mm beside the cube; the second and third are there and move nothing.
  const Vec3 hinge = place(s) - Vec3(0.03, 0, 0);
  const Real about = kInertia + kMass * 9e-4;  // Steiner
  Real rate = 10;
  for (int k = 0; k < 10; ++k) {
    ArticulationStep step{VectorXd::Zero(3), MatrixXd::Identity(3, 3), {MatrixXd::Zero(6, 3)}};
    step.predicted[0] = 0.002 * rate;
    step.inertia(0, 0) = about;
    step.jacobian[0].col(0) << Vec3::UnitY().cross(place(s) - hinge), Vec3::UnitY();
    s.exchange.articulations = {step};
    const ArticulationReport& r = s.step().articulations[0];
    const Wrench& push = r.links[0].normal;
    const Real torque = push.torque.y() + (place(s) - hinge).cross(push.force).y();
    EXPECT_TRUE(k == 0 || torque < 0) << "the strip pushes back";
    // The arm is that of the step's start, as the coordinate's is; it turns by at most 0.02 rad in a step.
    EXPECT_NEAR(r.links[0].normal.force.dot(step.jacobian[0].col(0).head<3>()) + push.torque.y() + r.links[0].friction.torque.y() +
                    r.links[0].friction.force.dot(step.jacobian[0].col(0).head<3>()),
                r.force[0], 1e-12);
    EXPECT_NEAR(about * (r.q[0] - step.predicted[0]) / 4e-6, r.force[0], 1e-8);
    EXPECT_EQ(r.q[1], 0);
    rate = r.q[0] / 0.002;
  }
  EXPECT_TRUE(s.broken.empty());
  EXPECT_LT(rate, 9.5);
  EXPECT_NEAR((place(s) - hinge).norm(), 0.03, 3e-4);
}
TEST(Articulation, WhatSomebodyElseKeepsApartMeetsOnlyWherePinching) {
  tape::Setup s = strip_and_cube(Motion::linked, 1e-5);
  test::add_body(s, "table", box_mesh(Vec3(0.02, 0.02, 0.002)), Motion::fixed, Vec3(0.002, 0.001, 0.0125));
  for (Body& body : s.scene.bodies) body.outside = true;
  for (const bool pinching : {false, true}) {
    test::Simulation sim(s);
    Cube outside{.v = Vec3(0, 0, 0.5)};
    sim.check_intersections = pinching;
    for (int k = 0; k < 5; ++k) {
      sim.exchange = {.articulations = {outside.step(0.002)}, .pinching = {}};
      if (pinching) sim.exchange.pinching = {{0, 1}};
      outside.take(sim.step().articulations[0], 0.002);
    }
    EXPECT_TRUE(sim.broken.empty()) << sim.broken.front();
    if (pinching) {
      EXPECT_LT(place(sim).z(), 0.0065);  // the table begins at 0.0115
    } else {
      EXPECT_NEAR(place(sim).z(), 0.0055 + 5 * 0.002 * 0.5, 1e-9);
    }
  }
}
TEST(Articulation, ALinkMeetsWhatOnlyTheTapeSideHas) {
  tape::Setup s = strip_and_cube(Motion::linked, 1e-5);
  test::add_body(s, "table", box_mesh(Vec3(0.02, 0.02, 0.002)), Motion::fixed, Vec3(0.002, 0.001, 0.0125));
  s.scene.bodies[0].outside = true;
  test::Simulation sim(s);
  Cube outside{.v = Vec3(0, 0, 0.5)};
  for (int k = 0; k < 5; ++k) {
    sim.exchange = {.articulations = {outside.step(0.002)}, .pinching = {}};
    outside.take(sim.step().articulations[0], 0.002);
  }
  EXPECT_TRUE(sim.broken.empty()) << sim.broken.front();
  EXPECT_LT(place(sim).z(), 0.0065);
}
/// A slide that holds still with 100 N/m (drive / dt^2) and at most 0.2 N, pushed by a cube that weighs 0.5 N.
TEST(Articulation, ADriveAtItsLimitPushesOnWithThat) {
  tape::Setup s = test::strip_setup(test::flat_strip(0.02, 2, Vec3(0, 0, -1)));  // far away
  s.scene.time.dt = 0.002;
  Body& slide = test::add_body(s, "slide", box_mesh(Vec3::Constant(kSide)), Motion::linked, Vec3::Zero());
  slide.xi = 0;
  Body& cube = test::add_body(s, "cube", box_mesh(Vec3::Constant(kSide)), Motion::dynamic, Vec3(0, 0, kSide + 1e-4));
  cube.mass = 0.5 / 9.81;
  s.scene.articulations = {{"slide", {"slide"}, 1}};
  s.newton.velocity_tol = 1e-6;
  test::Simulation sim(s);
  constexpr Real kDt = 0.002, kBare = 0.01;  // [s], [kg]
  Real v = 0;
  for (int k = 0; k < 20; ++k) {
    MatrixXd J = MatrixXd::Zero(6, 1);
    J(2, 0) = 1;
    ArticulationStep step{VectorXd::Constant(1, kDt * v), MatrixXd::Constant(1, 1, kBare), {J}};
    step.springs = {{VectorXd::Ones(1), 100 * kDt * kDt, -0.2, 0.2}};
    sim.exchange = {.articulations = {step}, .pinching = {}};
    const ArticulationReport report = sim.step().articulations[0];
    const Real ahead = report.q[0] - kDt * v, drive = std::clamp(100 * ahead, -0.2, 0.2);
    EXPECT_NEAR(report.force[0], kBare * ahead / (kDt * kDt) + drive, 1e-5) << k;  // what pushes is what mass and drive take up
    v = report.q[0] / kDt;
  }
  EXPECT_TRUE(sim.broken.empty()) << sim.broken.front();
}
TEST(Articulation, ALinkWithoutArticulationIsRefusedByName) {
  tape::Setup s = strip_and_cube(Motion::linked, 1e-5);
  s.scene.articulations.clear();
  EXPECT_THROW(World::build(s), InputError);
  s.scene.articulations = {{"free", {"cube", "cube"}, 6}};
  EXPECT_THROW(World::build(s), InputError);
}
