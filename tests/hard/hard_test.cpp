#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cstdio>

#include "tape/math/rotation.hpp"
#include "tape/model/primitives.hpp"
#include "tests/hard/hard_case.hpp"
using namespace tape;
using test::HardCase;
using test::Simulation;

namespace {
/// Runs a case until a time [s], with or without the check for intersections; what it breaks is added to `broken`.
Simulation run(const HardCase& hard, Real until, bool check, std::vector<std::string>& broken) {
  Simulation simulation(hard.setup());
  simulation.check_intersections = check;
  Real scale = 0, energy = 1e300, booked = 0;
  simulation.run_to(until, [&](const Simulation& s) {
    booked += s.report().adhesion_work;
    const Real now = s.energy() - booked;
    scale = std::max(scale, s.energy_scale());
    if (!hard.driven && now > energy + hard.energy_rise * scale)
      broken.push_back("step " + std::to_string(s.state().step) + ": energy rose by " + to_text((now - energy) / scale) + " of its scale");
    energy = now;
  });
  broken.insert(broken.end(), simulation.broken.begin(), simulation.broken.end());
  return simulation;
}

class Hard : public testing::TestWithParam<HardCase> {};
}  // namespace

TEST_P(Hard, KeepsItsPromises) {
  const HardCase& hard = GetParam();
  std::vector<std::string> broken;
  const auto start = std::chrono::steady_clock::now();
  const Simulation whole = run(hard, hard.duration, true, broken);
  if (hard.also) hard.also(whole, broken);
  std::vector<std::string> ignored;
  const Simulation half = run(hard, hard.duration / 3, false, ignored), again = run(hard, hard.duration / 3, false, ignored);
  if (half.state().hash() != again.state().hash()) broken.push_back("a second run differs");
  const Real seconds = std::chrono::duration<Real>(std::chrono::steady_clock::now() - start).count();
  std::printf("%-28s %5d steps  %5.1f Newton a step (max %3d)  smallest gap %9.2e m  %6.2f s  %s\n", hard.name.c_str(), whole.state().step,
              whole.newton_sum / std::max<Real>(1, whole.state().step), whole.newton_max, whole.min_gap, seconds,
              broken.empty() ? "ok" : "BROKEN");
  for (std::size_t k = 0; k < std::min<std::size_t>(3, broken.size()); ++k) ADD_FAILURE() << hard.what << ": " << broken[k];
}
INSTANTIATE_TEST_SUITE_P(Cases, Hard, testing::ValuesIn(test::hard_cases()), [](const auto& hard) {
  std::string name = hard.param.name;
  std::replace(name.begin(), name.end(), '-', 'm');
  return name;
});

/// HC7: a start that touches or interpenetrates is refused, and the message names both.
TEST(HardStart, ExactlyTouchingOrInterpenetratingIsRefusedByName) {
  for (const Real z : {0.0, 4.5e-5, 2e-5, -0.002}) {
    tape::Setup setup = test::dropped_strip(0.03, 3, z);
    test::add_body(setup, "table", box_mesh(Vec3(0.1, 0.06, 0.01)), Motion::fixed, Vec3(0, 0, -0.005));
    try {
      Simulation simulation(setup);
      ADD_FAILURE() << "accepted a strip at z = " << z;
    } catch (const InputError& e) {
      EXPECT_NE(std::string(e.what()).find("tape"), std::string::npos) << e.what();
      EXPECT_NE(std::string(e.what()).find("table"), std::string::npos) << e.what();
    }
  }
}
