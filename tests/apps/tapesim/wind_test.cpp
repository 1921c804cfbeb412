#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tests/apps/tapesim/program.hpp"

using namespace tape::test;
using nlohmann::json;
using testing::HasSubstr;

namespace {
const std::string kFilm = TAPE_SOURCE_DIR "/data/tapes/vinyl_19mm.yaml";
constexpr const char* kScene = R"(scene: falling_roll
film: vinyl_19mm
time: {dt: 0.01, duration: 0.12}
strip: {cells_across: 3, cell_length: 0.003}
roll: {turns: 1.2, free_length: 0.01, position: [0, 0, 0.03], asset: roll.h5}
bodies: {table: {shape: box, size: [0.2, 0.1, 0.02], position: [0, 0, -0.01]}}
interfaces:
  - {between: [tape.sticky, tape], law: per_pair, cn: 1, ct: 1, beta0: 1}
  - {between: [tape.sticky, hub], law: per_pair, cn: 1, ct: 1, beta0: 1}
record: {figures: [roll, hub_travel]}
)";

class Wind : public testing::Test {
 protected:
  Outcome wind(const std::vector<std::string>& more = {}) const {
    std::vector<std::string> arguments{"wind", kFilm, "--turns", "1.2", "--out", (folder / "roll.h5").string()};
    for (const char* set : {"strip.cells_across=3", "strip.cell_length=0.003", "roll.free_length=0.01"})
      arguments.insert(arguments.end(), {"--set", set});
    arguments.insert(arguments.end(), more.begin(), more.end());
    return tapesim(arguments);
  }
  Outcome run(const std::string& out, const std::vector<std::string>& more = {}) const {
    std::vector<std::string> arguments{"run", scene, "--out", (folder / out).string()};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return tapesim(arguments);
  }
  json report(const std::string& out) const { return json::parse(read(folder / out / "report.json")); }

  Folder folder;
  std::string scene = folder.file("falling_roll.yaml", kScene);
};
}  // namespace

TEST_F(Wind, ARollFallsTheSameForAnyThreadsAndAfterAResume) {
  ASSERT_EQ(wind().exit_code, 0);
  ASSERT_EQ(run("one", {"--threads", "1"}).exit_code, 0);
  const json whole = report("one");
  for (const char* threads : {"2", "8"}) {
    ASSERT_EQ(run("more", {"--threads", threads}).exit_code, 0);
    EXPECT_EQ(report("more")["state_hash"], whole["state_hash"]) << threads << " threads";
  }
  ASSERT_EQ(run("parts", {"--steps", "6"}).exit_code, 0);
  ASSERT_EQ(run("parts", {"--resume", (folder / "parts" / "snapshot.h5").string()}).exit_code, 0);
  EXPECT_EQ(report("parts")["state_hash"], whole["state_hash"]);
  // It falls from 30 mm, hub of 21 mm and the tape around it, and lies on the table: it neither hovers nor sinks in.
  EXPECT_NEAR(whole["figures"]["hub_travel_m"].get<double>(), 0.0087, 4e-4);
  EXPECT_GT(whole["min_gap_m"].get<double>(), 0);
}
TEST_F(Wind, TheReportSaysHowItAdheres) {
  ASSERT_EQ(wind().exit_code, 0);
  ASSERT_EQ(run("a", {"--steps", "1"}).exit_code, 0);
  const json adhesion = report("a")["settings"]["adhesion"];
  ASSERT_EQ(adhesion.size(), 2u);
  EXPECT_EQ(adhesion[0]["law"], "per_pair");
  EXPECT_EQ(adhesion[0]["cn"], 1);
  EXPECT_EQ(adhesion[1]["between"], json({"tape", "hub"}));
}
TEST_F(Wind, AnAssetOfOtherSettingsIsRefused) {
  ASSERT_EQ(wind({"--set", "interfaces.0.cn=2"}).exit_code, 0);
  const Outcome outcome = run("a");
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_THAT(outcome.err, HasSubstr("cn = 2, the scene says"));
  EXPECT_EQ(run("a", {"--set", "roll.asset=none.h5"}).exit_code, 2);
}
TEST_F(Wind, AnAssetForTapeThatDoesNotStickIsRefused) {
  ASSERT_EQ(wind().exit_code, 0);
  const Outcome outcome = run("a", {"--set", "interfaces.0.law=none"});
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_THAT(outcome.err, HasSubstr("does not adhere to itself"));
}
TEST_F(Wind, ASnapshotGoesOnOnlyWithTheModelThatMadeIt) {
  ASSERT_EQ(wind().exit_code, 0);
  ASSERT_EQ(run("a", {"--steps", "2"}).exit_code, 0);
  const std::string snapshot = (folder / "a" / "snapshot.h5").string();
  const Outcome outcome = run("b", {"--resume", snapshot, "--model", "bond-f", "--set", "roll.asset=~"});
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_THAT(outcome.err, HasSubstr("it remembers pairs of 'cohesion'"));
}
TEST_F(Wind, ASnapshotOfAReducedRollGoesOnOnlyWithItsCollar) {
  ASSERT_EQ(wind().exit_code, 0);
  ASSERT_EQ(run("a", {"--steps", "2", "--model", "coh-r"}).exit_code, 0);
  const std::string snapshot = (folder / "a" / "snapshot.h5").string();
  const Outcome outcome = run("b", {"--resume", snapshot, "--model", "coh-r", "--set", "cluster.collar=6"});
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_THAT(outcome.err, HasSubstr("collar"));
}
TEST_F(Wind, AnOutputThatCannotBeWrittenIsFoundBeforeTheWork) {
  const Outcome outcome = tapesim({"wind", kFilm, "--turns", "32", "--out", "/dev/full/roll.h5"});
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_THAT(outcome.err, HasSubstr("/dev/full/roll.h5"));
}
