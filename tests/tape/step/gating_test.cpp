// Only what the scene calls for: checks.md part 10.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tape/model/primitives.hpp"
#include "tests/support/gating.hpp"
using namespace tape;
using namespace tape::test;

namespace {
constexpr Real kSame = 1e-12;  // [m] checks.md part 10, E1

Simulation after(tape::Setup setup, int steps) {
  Simulation simulation(std::move(setup));
  for (int k = 0; k < steps; ++k) simulation.step();
  EXPECT_TRUE(simulation.broken.empty()) << simulation.broken.front();
  return simulation;
}
Real largest_difference(const Simulation& a, const Simulation& b) {
  Real most = 0;
  for (std::size_t v = 0; v < a.state().x.size(); ++v) most = std::fmax(most, (a.state().x[v] - b.state().x[v]).cwiseAbs().maxCoeff());
  return most;
}
bool reported(const StepReport& report, const std::string& effect) {
  return std::any_of(report.effects.begin(), report.effects.end(), [&](const EffectReport& e) { return e.name == effect; });
}

}  // namespace

TEST(Gating, WithoutFrictionIsFrictionOfCoefficientZero) {
  auto none = draped();
  none.scene.materials[0].mu = 0;
  const Simulation zero = after(frictionless(), 8), off = after(without(draped(), {"friction"}), 8), not_needed = after(none, 8);
  EXPECT_TRUE(reported(zero.report(), "friction"));
  EXPECT_FALSE(reported(off.report(), "friction"));
  EXPECT_FALSE(reported(not_needed.report(), "friction")) << "mu = 0 asks for no friction";
  EXPECT_LE(largest_difference(zero, off), kSame);
  EXPECT_LE(largest_difference(zero, not_needed), kSame);
  EXPECT_GT(zero.report().active_pairs, 0);
  EXPECT_GT(largest_difference(zero, after(draped(), 8)), 1e-5) << "friction would not matter here";
}
TEST(Gating, WithoutContactIsContactThatNothingComesNear) {
  const Simulation far = after(swinging(), 8), off = after(without(swinging(), {"barrier", "friction"}), 8);
  EXPECT_TRUE(reported(far.report(), "barrier"));
  EXPECT_FALSE(reported(off.report(), "barrier"));
  EXPECT_LE(largest_difference(far, off), kSame);
}
TEST(Gating, WithoutBendingIsAFilmThatDoesNotResistIt) {
  const Simulation zero = after(limp(), 8), off = after(without(swinging(), {"bending"}), 8);
  EXPECT_TRUE(reported(zero.report(), "bending"));
  EXPECT_FALSE(reported(off.report(), "bending"));
  EXPECT_LE(largest_difference(zero, off), kSame);
  EXPECT_GT(largest_difference(zero, after(swinging(), 8)), 1e-6) << "bending would not matter here";
}
TEST(Gating, LookingOnlyWhereThingsMeetChangesNoBit) {
  auto setup = draped();
  add_body(setup, "under", box_mesh(Vec3(0.08, 0.04, 0.01), {8, 4, 1}), Motion::dynamic, Vec3(0.01, 0, -0.0252));
  add_body(setup, "far", box_mesh(Vec3(0.1, 0.1, 0.01)), Motion::dynamic, Vec3(1, 0, 0));
  const Simulation there = after(setup, 12);
  setup.scene.contact.everywhere = true;
  const Simulation everywhere = after(setup, 12);
  EXPECT_GT(there.report().active_pairs, 0);
  EXPECT_EQ(there.report().candidates, everywhere.report().candidates);
  EXPECT_EQ(there.state().hash(), everywhere.state().hash());
}
TEST(Gating, AStripFarFromEverythingHasNoPairsAndSpendsNoTimeOnThem) {
  auto setup = swinging();
  setup.scene.grips.clear();
  setup.scene.bodies[0].pose.position.z() = -1;
  Simulation s(setup);
  for (int k = 0; k < 40; ++k) {  // in the end it falls by six cells in a step
    s.step();
    ASSERT_EQ(s.report().candidates, 0) << "step " << k;
    EXPECT_EQ(s.report().active_pairs, 0);
    for (const StageReport& stage : s.report().stages) EXPECT_TRUE(stage.name != "ccd" || stage.ms == 0);
    for (const EffectReport& effect : s.report().effects)
      EXPECT_TRUE((effect.name != "barrier" && effect.name != "friction") || effect.ms == 0) << effect.name;
  }
  EXPECT_TRUE(s.broken.empty()) << s.broken.front();
}
