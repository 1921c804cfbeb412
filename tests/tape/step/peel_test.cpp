#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <numbers>

#include "tape/model/primitives.hpp"
#include "tape/model/strip_mesh.hpp"
#include "tests/support/simulation.hpp"
using namespace tape;

namespace {
constexpr Real kWidth = 6e-3, kToughness = 1, kStuck = 0.03;  // [m], [J/m^2], [m]

/// What a peel measures over its second half.
struct Peel {
  Real force = 0;    ///< [N] mean
  Real angle = 0;    ///< [deg] at which it pulls
  Real advance = 0;  ///< [m] of the front
  std::vector<std::string> broken;
};

/// A narrow strip of the vinyl film, stuck to a table by area, is peeled from its end at an angle without gravity. The hand moves such
/// that the arm keeps its angle: by (-1 + cos, sin) per length peeled. D = 3.05e-5 N m: the fold's radius at the front, sqrt(D/2R), is 3.9
/// mm; an arc of twice that has the asymptote of the elastica in equilibrium, at every angle.
Peel peel(Real angle_deg, Real cell, int samples = 2) {
  const Real angle = angle_deg * std::numbers::pi / 180, fold = 7.8e-3, arm = 0.02, peeled = 0.016, speed = 0.02;
  Strip strip = test::flat_strip(kStuck + fold * angle + arm, 2, Vec3(0, 0, 0));
  strip.mesh.cell_length = cell;
  strip.path = {{kStuck, 0}, {fold * angle, angle}};
  Setup setup = test::strip_setup(strip);
  Scene& scene = setup.scene;
  Film& film = scene.films[0];
  film.width = kWidth;
  scene.strips[0].pose.position.z() = film.xi + 0.79 * film.dhat;
  scene.gravity.setZero();
  scene.contact.kappa = 1e3;
  test::add_body(setup, "table", box_mesh(Vec3(0.1, 0.02, 0.01), {10, 4, 1}), Motion::fixed, Vec3(0.01, 0, -0.005)).material = 1;
  scene.materials.push_back({"table", 0.5});
  scene.adhesives = {{0,
                      1,
                      {AdhesionLaw::per_area,
                       {{false, false}, {true, true}},
                       {},
                       {.strength = 5e3, .toughness = kToughness, .peak = 0.1, .shear = 1, .rest = 0.8, .reach = 0.8},
                       {}}}};
  params<CohesiveZone>(setup.effects).samples = samples;
  Grip hand = test::hold("hand", tip_vertices(make_strip_mesh(strip.mesh, film.width, scene.seed), 1e-6));
  const Real time = peeled / speed;
  hand.motion = {{0, time, peeled * Vec3(std::cos(angle) - 1, 0, std::sin(angle))}};
  scene.grips = {hand};
  setup.newton.velocity_tol = 1e-4;
  test::Simulation s(setup);
  Peel out;
  Real half = 0;
  int steps = 0;
  Vec3 force = Vec3::Zero();
  s.run_to(time, [&](const test::Simulation& at) {
    const Real front = at.report().adhesion[0].to;
    if (at.state().time < time / 2 + 1e-9) {
      half = front;
      return;
    }
    ++steps;
    force += at.report().grip_force[0];
    out.advance = half - front;
  });
  out.force = force.norm() / steps;
  out.angle = std::atan2(force.z(), force.x()) * 180 / std::numbers::pi;
  out.broken = s.broken;
  return out;
}
/// Of an unstretchable film: F = R b/(1 - cos).
Real kendall(Real angle_deg) { return kToughness * kWidth / (1 - std::cos(angle_deg * std::numbers::pi / 180)); }
}  // namespace

TEST(Peel, ByAreaFollowsKendallAtEveryAngle) {
  std::map<Real, Real> force;
  for (Real angle : {60.0, 90.0, 180.0}) {
    const Peel p = peel(angle, 8e-4);
    force[angle] = p.force;
    EXPECT_TRUE(p.broken.empty()) << p.broken.front();
    EXPECT_NEAR(p.angle, angle, 3);
    EXPECT_NEAR(p.force / kendall(p.angle), 1, 0.03) << angle << " degrees";
    EXPECT_NEAR(p.advance, 0.008, 8e-4) << angle << " degrees: to a cell";
  }
  EXPECT_NEAR(force[90] / force[180], 2.000, 0.05 * 2);
  EXPECT_NEAR(force[60] / force[180], 3.999, 0.05 * 4);
}
TEST(Peel, ByAreaDoesNotDependOnTheMesh) {
  Real least = std::numeric_limits<Real>::infinity(), most = 0;
  for (Real cell : {1.1e-3, 8e-4, 6e-4}) {
    const Real force = peel(180, cell).force;
    EXPECT_NEAR(force / kendall(180), 1, 0.03) << cell << " m";
    least = std::fmin(least, force), most = std::fmax(most, force);
  }
  EXPECT_LT(most / least, 1.03);
}
