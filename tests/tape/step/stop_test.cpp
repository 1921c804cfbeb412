#include <gtest/gtest.h>

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
