#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "tape/model/primitives.hpp"
#include "tests/support/simulation.hpp"
using namespace tape;

/// A strip that starts in the band of a ceiling falls with g at once, whatever the tolerance: Newton leaves the barrier by thirds of the
/// way to its edge, so that updates are small long before the step is done.
TEST(Stop, WhatLeavesContactFallsAtEveryTolerance) {
  for (const HessianMode mode : {HessianMode::exact, HessianMode::projected}) {
    for (const Real tolerance : {1e-1, 1e-2, 1e-3}) {
      const Film film = test::vinyl();
      auto setup = test::strip_setup(test::flat_strip(0.03, 3, Vec3(-0.015, 0, -film.xi - 0.8 * film.dhat)));
      setup.newton.velocity_tol = tolerance;
      setup.newton.hessian = mode;
      test::add_body(setup, "ceiling", box_mesh(Vec3(0.06, 0.04, 0.01)), Motion::fixed, Vec3(0, 0, 0.005));
      test::Simulation s(setup);
      for (int k = 0; k < 10; ++k) s.step();
      EXPECT_TRUE(s.broken.empty()) << s.broken.front();
      // Implicit Euler falls by g dt^2 n (n + 1)/2 from rest, and the barrier only pushes down; what an update may leave is tol dt.
      const Real fallen = 9.81 * 1e-4 * 55;
      for (const Vec3& p : s.state().x) EXPECT_LT(p.z(), -0.99 * fallen) << tolerance << " m/s, " << to_text(mode);
    }
  }
}

/// A strip falls on a drum and wraps around it. What a step says that it has left to go is at least half of what a much tighter tolerance
/// changes from the same state, and not many times as much (measured 0.8 at least, 14 in the median; |dx| rho/(1 - rho): 0.16 and 100).
TEST(Stop, TheEstimateCoversWhatATighterToleranceChanges) {
  auto setup = test::strip_setup(test::flat_strip(0.06, 4, Vec3(-0.028, 0, 0.0103)));
  test::add_body(setup, "drum", cylinder_mesh(0.01, 0.04, 48, 1), Motion::fixed, Vec3::Zero()).pose.rotation << 1, 0, 0, 0, 0, -1, 0, 1, 0;
  test::Simulation loose(setup);
  setup.newton.velocity_tol = 1e-8;
  test::Simulation tight(setup);
  std::vector<Real> ratio;
  for (int k = 0; k < 40; ++k) {
    tight.state() = loose.state();
    loose.step(), tight.step();
    Real changed = 0;
    for (std::size_t v = 0; v < loose.state().x.size(); ++v)
      changed = std::max(changed, (loose.state().x[v] - tight.state().x[v]).cwiseAbs().maxCoeff());
    if (changed > 1e-11) ratio.push_back(loose.report().stop_error_estimate / changed);
  }
  EXPECT_TRUE(loose.broken.empty() && tight.broken.empty());
  ASSERT_GT(ratio.size(), 30u);
  std::ranges::sort(ratio);
  EXPECT_GT(ratio.front(), 0.5);
  EXPECT_LT(ratio[ratio.size() / 2], 30);
}
