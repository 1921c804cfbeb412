#include <gtest/gtest.h>

#include <algorithm>
#include <array>
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
  simulation.may_reach_limits = hard.may_reach_limits;
  Real scale = 0, energy = 1e300, booked = 0;
  simulation.run_to(until, [&](const Simulation& s) {
    booked += s.report().adhesion_work + s.report().woken;
    const Real now = s.energy() - booked;
    scale = std::max(scale, s.energy_scale());
    if (!hard.driven && now > energy + hard.energy_rise * scale)
      broken.push_back("step " + std::to_string(s.state().step) + ": energy rose by " + to_text((now - energy) / scale) + " of its scale");
    energy = std::min(energy, now);
  });
  broken.insert(broken.end(), simulation.broken.begin(), simulation.broken.end());
  return simulation;
}

/// Prints one table when all cases are done.
class Table : public testing::Environment {
 public:
  static void add(const HardCase& hard, const Simulation& s, Real seconds, bool ok) {
    std::array<char, 160> row;
    std::snprintf(row.data(), row.size(), "%-30s %6d %7.1f %5d %8d %7d %12.2e %8.2f  %s\n", hard.name.c_str(), s.state().step,
                  s.newton_sum / std::max<Real>(1, s.state().step), s.newton_max, s.retried, s.ccd_capped, s.min_gap, seconds,
                  ok ? "ok" : "BROKEN");
    rows_ += row.data();
    total_ += seconds;
    ++cases_;
  }
  void TearDown() override {
    if (cases_ == 0) return;
    std::printf("%-30s %6s %7s %5s %8s %7s %12s %8s\n", "case", "steps", "Newton", "most", "retried", "capped", "min gap [m]", "time [s]");
    std::printf("%s%d cases in %.0f s\n", rows_.c_str(), cases_, total_);
  }

 private:
  inline static std::string rows_;
  inline static Real total_ = 0;
  inline static int cases_ = 0;
};
testing::Environment* const g_table = testing::AddGlobalTestEnvironment(new Table);

class Hard : public testing::TestWithParam<HardCase> {};
}  // namespace

TEST_P(Hard, KeepsItsPromises) {
  const HardCase& hard = GetParam();
  std::vector<std::string> broken;
  const auto start = std::chrono::steady_clock::now();
  const Simulation whole = run(hard, hard.duration, true, broken);
  if (hard.also) hard.also(whole, broken);
  std::vector<std::string> ignored;  // they would be those of the first run
  if (run(hard, hard.duration, false, ignored).state().hash() != whole.state().hash()) broken.push_back("a second run differs");
  const Real seconds = std::chrono::duration<Real>(std::chrono::steady_clock::now() - start).count();
  Table::add(hard, whole, seconds, broken.empty());
  for (std::size_t k = 0; k < std::min<std::size_t>(3, broken.size()); ++k) ADD_FAILURE() << hard.what << ": " << broken[k];
}
INSTANTIATE_TEST_SUITE_P(Cases, Hard, testing::ValuesIn(test::hard_cases()), [](const auto& hard) {
  std::string name = hard.param.name;
  std::replace(name.begin(), name.end(), '-', 'm');
  return name;
});

/// HC12: the pose at rest does not depend on dt.
TEST(HardSteps, AStripComesToRestInTheSamePlaceForEveryTimeStep) {
  std::vector<Vec3> reference;
  for (const HardCase& hard : test::hard_cases()) {
    if (hard.name.rfind("HC12_dt_", 0) != 0) continue;
    std::vector<std::string> broken;
    const std::vector<Vec3> rest = run(hard, hard.duration, false, broken).state().x;
    if (reference.empty()) reference = rest;
    for (std::size_t v = 0; v < rest.size(); ++v) ASSERT_LT((rest[v] - reference[v]).norm(), 1e-4) << hard.name << ", vertex " << v;
  }
  EXPECT_FALSE(reference.empty());
}

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
