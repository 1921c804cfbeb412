// Only what the scene calls for: checks.md part 10.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "tape/math/rotation.hpp"
#include "tape/model/primitives.hpp"
#include "tests/support/simulation.hpp"
using namespace tape;
using test::hold;
using test::Simulation;

namespace {
constexpr Real kSame = 1e-12;  // [m] checks.md part 10, E1

/// A strip that drops onto a drum and slides off it.
tape::Setup draped() {
  auto setup = test::strip_setup(test::flat_strip(0.06, 3, Vec3(-0.02, 0, 0.0205)));
  test::add_body(setup, "drum", cylinder_mesh(0.02, 0.03, 24, 1), Motion::fixed, Vec3::Zero()).pose.rotation =
      rotation_exp(Vec3(std::numbers::pi / 2, 0, 0));
  setup.newton.velocity_tol = 1e-6;
  return setup;
}
/// A strip that hangs by its root, swings, and comes near to nothing.
tape::Setup swinging() {
  Strip strip = test::flat_strip(0.05, 3, Vec3::Zero());
  strip.pose.rotation = rotation_exp(Vec3(0, std::numbers::pi / 3, 0));
  auto setup = test::strip_setup(strip);
  setup.scene.grips = {hold("hook", root_vertices(make_strip_mesh(strip.mesh, 0.019, 1), 1e-9))};
  test::add_body(setup, "floor", box_mesh(Vec3(0.2, 0.2, 0.01)), Motion::fixed, Vec3(0, 0, -0.2));
  setup.newton.velocity_tol = 1e-6;
  return setup;
}
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

tape::Setup without(tape::Setup setup, std::initializer_list<std::string> effects) {
  for (const std::string& effect : effects) setup.forced[effect] = false;
  return setup;
}
tape::Setup frictionless() {  // built all the same
  auto setup = draped();
  setup.scene.materials[0].mu = 0;
  setup.forced["friction"] = true;
  return setup;
}
tape::Setup limp() {
  auto setup = swinging();
  setup.scene.films[0].bending_modulus = 1e-20;
  return setup;
}

/// Median over several pairs of runs of the time of `off` over that of `zero`. Runs alternate, so that both see the same machine.
Real time_ratio(const tape::Setup& off, const tape::Setup& zero) {
  const auto time = [](const tape::Setup& setup) {
    Simulation simulation(setup);
    simulation.check_intersections = false;
    Real ms = 0;
    for (int k = 0; k < 20; ++k) ms += simulation.step().wall_ms;
    return ms;
  };
  std::vector<Real> ratio;
  for (int k = 0; k < 11; ++k) ratio.push_back(time(off) / time(zero));
  std::sort(ratio.begin(), ratio.end());
  return ratio[ratio.size() / 2];
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
TEST(Gating, AStripFarFromEverythingHasNoPairsAndSpendsNoTimeOnThem) {
  auto setup = swinging();
  setup.scene.grips.clear();  // it falls, and in these steps by less than a cell each
  Simulation s(setup);
  for (int k = 0; k < 3; ++k) {
    s.step();
    EXPECT_EQ(s.report().candidates, 0);
    EXPECT_EQ(s.report().active_pairs, 0);
    for (const StageReport& stage : s.report().stages) EXPECT_TRUE(stage.name != "ccd" || stage.ms == 0);
    for (const EffectReport& effect : s.report().effects)
      EXPECT_TRUE((effect.name != "barrier" && effect.name != "friction") || effect.ms == 0) << effect.name;
  }
  EXPECT_TRUE(s.broken.empty()) << s.broken.front();
}

TEST(GatingCost, OffIsNeverSlowerThanACoefficientOfZero) {  // by more than two equal runs differ: 5 %
  EXPECT_LE(time_ratio(without(draped(), {"friction"}), frictionless()), 1.05) << "friction";
  EXPECT_LE(time_ratio(without(swinging(), {"barrier", "friction"}), swinging()), 1.05) << "contact";
  EXPECT_LE(time_ratio(without(swinging(), {"bending"}), limp()), 1.05) << "bending";
}
