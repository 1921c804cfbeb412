#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>
#include <random>

#include "tests/apps/tapesim/program.hpp"

using namespace tape::test;
using nlohmann::json;

namespace {
/// Scenes must do what they state from where nobody tuned them: each seed draws another start.
class Jittered : public testing::TestWithParam<std::tuple<const char*, int>> {
 protected:
  double within(double limit) { return std::uniform_real_distribution<double>(-limit, limit)(random_); }
  /// The report of a run of a shipped scene with the model of this test.
  json run(const std::string& scene, const std::vector<std::string>& settings) const {
    std::vector<std::string> arguments{"run",       TAPE_SOURCE_DIR "/data/scenes/" + scene + ".yaml",
                                       "--model",   std::get<0>(GetParam()),
                                       "--threads", "1",
                                       "--out",     (folder_ / "run").string()};
    for (const std::string& setting : settings) arguments.insert(arguments.end(), {"--set", setting});
    const Outcome outcome = tapesim(arguments);
    EXPECT_EQ(outcome.exit_code, 0) << testing::PrintToString(settings) << ": " << outcome.out << outcome.err;
    return json::parse(read(folder_ / "run" / "report.json"));
  }

 private:
  Folder folder_;
  std::mt19937 random_{static_cast<unsigned>(std::get<1>(GetParam()))};
};
using LongBoxSealing = Jittered;
using LongPayout = Jittered;
}  // namespace

/// The box stands up to 5 mm and 2 degrees beside its place, friction on tape is up to 20 % higher or lower.
TEST_P(LongBoxSealing, MeetsItsConditionsWhereverTheBoxStands) {
  const double x = within(0.005), y = within(0.005), turned = within(2), friction = 1 + within(0.2);
  const json report = run(
      "box_sealing", {fmt::format("robots.carton.position=[{}, {}, 0]", x, y), fmt::format("robots.carton.rotation_deg=[0, 0, {}]", turned),
                      fmt::format("materials.default.mu={}", 0.5 * friction * friction)});  // pairs: the geometric mean
  EXPECT_EQ(report["intersections"], 0);
  EXPECT_EQ(report["newton"]["failed_steps"], 0);
}
INSTANTIATE_TEST_SUITE_P(CohR, LongBoxSealing, testing::Combine(testing::Values("coh-r"), testing::Range(1, 11)));
INSTANTIATE_TEST_SUITE_P(BondR, LongBoxSealing, testing::Combine(testing::Values("bond-r"), testing::Range(1, 11)));

/// The control: the same script with tape that does not adhere.
TEST(LongBoxControl, OnBoardThatHoldsNoTapeBothFlapsOpenAgainAndTheRunSaysSo) {
  const Folder folder;
  const Outcome outcome = tapesim({"run", TAPE_SOURCE_DIR "/data/scenes/box_sealing.yaml", "--threads", "1", "--set",
                                   "interfaces.5.strength=1", "--set", "interfaces.5.toughness=0.001", "--out", (folder / "run").string()});
  EXPECT_EQ(outcome.exit_code, 1) << outcome.err;
  const json report = json::parse(read(folder / "run" / "report.json"));
  EXPECT_EQ(report["intersections"], 0);
  EXPECT_EQ(report["newton"]["failed_steps"], 0);
  int flaps = 0;
  for (const json& condition : report["conditions"])
    if (condition["name"] == "right_flap_rad" || condition["name"] == "left_flap_rad") {
      EXPECT_FALSE(condition["met"]);
      EXPECT_LT(condition["value"], (90 - 20) * std::numbers::pi / 180) << condition["name"];
      ++flaps;
    }
  EXPECT_EQ(flaps, 2);
}

/// The hub is drawn up to 5 degrees aside, friction is up to 20 % higher or lower, the free tape up to 5 mm longer or shorter.
TEST_P(LongPayout, PaysOutWithoutCrossingWhereverItIsDrawn) {
  const double aside = within(5 * std::numbers::pi / 180), friction = 1 + within(0.2), longer = within(0.005);
  const json report =
      run("payout", {"roll.turns=32", fmt::format("script.2.by=[{}, 0, {}]", -0.44375 * std::cos(aside), 0.44375 * std::sin(aside)),
                     fmt::format("materials.default.mu={}", 0.5 * friction), fmt::format("roll.free_length={}", 0.05 + longer)});
  EXPECT_EQ(report["intersections"], 0);
  EXPECT_EQ(report["newton"]["failed_steps"], 0);
  EXPECT_GT(report["figures"]["boundary_advance_m"], 0.9 * 0.3705) << "the paper";
  EXPECT_LE(report["figures"]["boundary_advance_m"], report["figures"]["hub_travel_m"]);
}
INSTANTIATE_TEST_SUITE_P(CohR, LongPayout, testing::Combine(testing::Values("coh-r"), testing::Range(1, 11)));
INSTANTIATE_TEST_SUITE_P(BondR, LongPayout, testing::Combine(testing::Values("bond-r"), testing::Range(1, 11)));
