// What a step does when it cannot be solved: checks.md part 9, "caps never silent".
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "tape/model/primitives.hpp"
#include "tests/support/simulation.hpp"
using namespace tape;
using test::Simulation;
using testing::HasSubstr;

namespace {
constexpr int kSteps = 12;
/// A strip that drops onto a table.
tape::Setup dropped() {
  auto setup = test::strip_setup(test::flat_strip(0.04, 3, Vec3(-0.02, 0, 0.002)));
  test::add_body(setup, "table", box_mesh(Vec3(0.1, 0.06, 0.01)), Motion::fixed, Vec3(0, 0, -0.005));
  return setup;
}
/// The most Newton iterations that any of its steps takes.
int most_iterations() {
  Simulation simulation(dropped());
  for (int k = 0; k < kSteps; ++k) simulation.step();
  EXPECT_TRUE(simulation.broken.empty());
  return simulation.newton_max;
}
}  // namespace

TEST(Failure, AStepThatReachesItsLimitIsRetriedInHalvesAndSaysSo) {
  auto setup = dropped();
  setup.newton.max_newton = most_iterations() - 1;
  Simulation simulation(setup);
  int retried = 0;
  for (int k = 0; k < kSteps; ++k) {
    const StepReport& report = simulation.step();
    EXPECT_TRUE(report.ok) << report.failure;
    if (report.substeps == 1) continue;
    ++retried;
    EXPECT_GT(report.stop_error_estimate, 0);
  }
  EXPECT_GT(retried, 0);
  EXPECT_NEAR(simulation.state().time, kSteps * setup.scene.time.dt, 1e-15);
  EXPECT_EQ(simulation.state().step, kSteps);
}

TEST(Failure, WithoutRetriesTheStateIsTheLastGoodOne) {
  auto setup = dropped();
  setup.newton.max_newton = most_iterations() - 1;
  setup.newton.retries = 0;
  Simulation simulation(setup);
  std::string before = simulation.state().hash();
  for (int k = 0; k < kSteps && simulation.step().ok; ++k) before = simulation.state().hash();
  EXPECT_FALSE(simulation.report().ok);
  EXPECT_THAT(simulation.report().failure, HasSubstr("solver.max_newton"));
  EXPECT_EQ(simulation.state().hash(), before);
}

TEST(Failure, WhatIsNotFiniteIsNamedByEffectAndElement) {
  Simulation simulation(dropped());
  simulation.state().v[5].x() = std::numeric_limits<Real>::quiet_NaN();
  EXPECT_FALSE(simulation.step().ok);
  EXPECT_THAT(simulation.report().failure, HasSubstr("effect 'inertia', element 5"));
}

TEST(Failure, WhereTheExactHessianIsIndefiniteTheProjectedOneStepsIn) {
  // The ends of a flat strip are pushed together by a hundredth: it must buckle.
  const Strip strip = test::flat_strip(0.05, 3, Vec3::Zero());
  auto setup = test::strip_setup(strip);
  const StripMesh mesh = make_strip_mesh(strip.mesh, setup.scene.films[0].width, 1);
  setup.scene.grips = {test::hold("wall", root_vertices(mesh, 1e-9)), test::hold("push", tip_vertices(mesh, 1e-9))};
  setup.scene.grips[1].motion = {{0, 0.05, Vec3(-5e-4, 0, 0)}};
  int fallbacks[2];
  for (const HessianMode mode : {HessianMode::exact, HessianMode::projected}) {
    setup.newton.hessian = mode;
    Simulation simulation(setup);
    int& count = fallbacks[mode == HessianMode::projected];
    count = 0;
    for (int k = 0; k < 20; ++k) count += simulation.step().hessian_fallbacks;
    EXPECT_TRUE(simulation.broken.empty()) << simulation.broken.front();
    Real highest = 0;
    for (const Vec3& p : simulation.state().x) highest = std::fmax(highest, std::fabs(p.z()));
    EXPECT_GT(highest, 1e-3) << "it did not buckle";
  }
  EXPECT_GT(fallbacks[0], 0);
  EXPECT_EQ(fallbacks[1], 0);
}
