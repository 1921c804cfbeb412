#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <csignal>
#include <sstream>

#include "cosim/episode/replay_file.hpp"
#include "cosim/scene/scene_file.hpp"
#include "tests/apps/tapesim/program.hpp"

using namespace tape::test;
using testing::ContainsRegex;
using testing::HasSubstr;
using testing::IsSupersetOf;
using testing::Not;

namespace {
constexpr const char* kScene = R"(scene: small
film: {from: vinyl_19mm, poisson: 0}
time: {dt: 0.05, duration: 0.1}
strip: {length: 0.04, cells_across: 2}
script:
  - {grip: tape.rows, rows: [0, 1], as: clamp, stiffness: 1.0e+4}
effects: {gravity: off}
)";
constexpr const char* kStudy = R"(study: tiny
scene: small.yaml
set: {strip.length: 0.05}
grid:
  time.dt: [0.05, 0.025]
  strip.cells_across: [1, 2]
)";

class Command : public testing::Test {
 protected:
  Folder folder;
  std::string scene = folder.file("small.yaml", kScene);
};
using Explain = Command;
using Check = Command;
using Info = Command;
using StudyCommand = Command;
using Render = Command;

/// The line of `text` that starts with `name` and a space.
std::string line_of(const std::string& text, const std::string& name) {
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);)
    if (line.starts_with(name + " ")) return line;
  return "";
}
}  // namespace

TEST_F(Explain, NamesEveryEffectAndStageOnOrOffWithTheLineThatAsks) {
  const Outcome outcome = tapesim({"explain", scene, "--backend", "cpu"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_THAT(line_of(outcome.out, "membrane"), ContainsRegex("on .*small.yaml:4.*\\[cpu\\]$"));
  EXPECT_THAT(line_of(outcome.out, "tether"), ContainsRegex("on .*small.yaml:[56].*\\[cpu\\]$"));
  EXPECT_THAT(line_of(outcome.out, "gravity"), ContainsRegex("off .*effects.gravity .*small.yaml:7"));
  EXPECT_THAT(line_of(outcome.out, "body_drive"), ContainsRegex(" off "));
  for (const char* stage : {"broad_phase", "narrow_phase", "ccd", "assembly", "linear_solver", "line_search", "history", "reduction",
                            "cutting", "sleeping", "cosim"})
    EXPECT_THAT(line_of(outcome.out, stage), ContainsRegex(" on | off ")) << stage;
}
TEST_F(Explain, SaysWhereADefaultAsks) {
  const Outcome outcome = tapesim({"explain", scene, "--backend", "cpu", "--set", "effects=~"});
  EXPECT_THAT(line_of(outcome.out, "gravity"), ContainsRegex("on +gravity \\(default\\)"));
  EXPECT_THAT(line_of(outcome.out, "bending"), ContainsRegex("on .*small.yaml:2"));
}
TEST_F(Check, SaysThatASceneIsSoundAndWritesNothing) {
  const Outcome outcome = tapesim({"check", scene});
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr("sound"));
  EXPECT_EQ(folder.names(), std::vector<std::string>{"small.yaml"});
}
TEST_F(Check, TellsTheGapsOfARoll) {
  const std::string roll = folder.file("roll.yaml", "film: vinyl_19mm\nroll: {turns: 2}\n");
  EXPECT_THAT(line_of(tapesim({"check", roll}).out, "roll"),
              ContainsRegex("'tape': pitch 0.00018 m, gaps from .* to the hub .* between layers"));
  EXPECT_THAT(tapesim({"check", roll, "--set", "roll.pitch=4e-4"}).out, HasSubstr("lower roll.pitch"));
  EXPECT_THAT(line_of(tapesim({"check", roll}).out, "roll"), Not(HasSubstr("as it is wound"))) << "nothing would hold it together at rest";
  const std::string sticks =
      "interfaces: [{between: [tape.sticky, tape], law: per_pair, cn: 1.2345}, {between: [tape.sticky, hub], law: per_pair}]\n";
  EXPECT_THAT(line_of(tapesim({"check", folder.file("sticks.yaml", read(roll) + sticks)}).out, "roll"),
              HasSubstr("as it is wound: a run lets it come to rest first"));
  const Outcome crossed = tapesim({"check", roll, "--set", "strip.cell_length=0.005"});
  EXPECT_EQ(crossed.exit_code, 2);
  EXPECT_THAT(crossed.err, ContainsRegex("roll.yaml: roll 'tape': turn .* cross: raise roll.pitch"));
}
TEST_F(Explain, NamesTheRollThatMakesStripAndHub) {
  const Outcome outcome = tapesim({"explain", folder.file("roll.yaml", "film: vinyl_19mm\nroll: {turns: 1}\n")});
  EXPECT_THAT(line_of(outcome.out, "membrane"), ContainsRegex("on .*roll.yaml:2"));
  EXPECT_THAT(line_of(outcome.out, "body_inertia"), ContainsRegex("on .*roll.yaml:2"));
}
TEST_F(Info, TellsVersionBackEndsThreadsAndBuild) {
  const Outcome outcome = tapesim({"info"});
  ASSERT_EQ(outcome.exit_code, 0);
  for (const char* part : {"tapesim 0.", "cuda", "threads: ", "build: "}) EXPECT_THAT(outcome.out, HasSubstr(part));
}
TEST_F(Info, ListsSettingsWithDefaultUnitRangeAndMeaningAsRunsHelpDoes) {
  const std::string settings = tapesim({"info", "--settings"}).out;
  EXPECT_THAT(line_of(settings, "time.dt"), ContainsRegex("0\\.01 +s +\\(0, 1\\] +time step"));
  EXPECT_THAT(line_of(settings, "solver.stop"), HasSubstr("velocity, work"));
  EXPECT_THAT(tapesim({"run", "--help"}).out, HasSubstr(line_of(settings, "time.dt")));
}
TEST_F(Info, TellsWhatWasUnderstoodOfARobotAndRefusesOneThatIsNone) {
  const Outcome arm = tapesim({"info", "--robot", TAPE_SOURCE_DIR "/data/robots/arm7.urdf"});
  ASSERT_EQ(arm.exit_code, 0) << arm.err;
  EXPECT_THAT(arm.out, testing::AllOf(HasSubstr("robot arm7: links: 8, joints: 7"), HasSubstr("mass: 18.6 kg in all")));
  const Outcome none = tapesim({"info", "--robot", "none.urdf"});
  EXPECT_EQ(none.exit_code, 2);
  EXPECT_EQ(none.err, "tapesim: none.urdf: there is no such file\n");
}
TEST_F(StudyCommand, AgainstAClosedFormPrintsATableAndLeavesCsvAndPlots) {
  const std::string study = folder.file("study.yaml", std::string(kStudy) + "against: {closed_form: heavy_elastica}\n");
  const Outcome outcome = tapesim({"study", study, "--out", (folder / "out").string()});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_THAT(folder.names("out"), testing::ElementsAre("runs.json", "study.csv", "study.png", "study.svg"));
  const std::string first = read(folder / "out" / "study.csv");
  EXPECT_EQ(tapesim({"study", study, "--out", (folder / "out").string()}).exit_code, 0);
  EXPECT_EQ(read(folder / "out" / "study.csv"), first) << "to the microsecond: nothing was run again";
  EXPECT_EQ(tapesim({"study", study, "--out", (folder / "out").string(), "--set", "seed=2"}).exit_code, 0);
  EXPECT_NE(read(folder / "out" / "study.csv"), first);
  std::istringstream csv(read(folder / "out" / "study.csv"));
  std::string line;
  std::getline(csv, line);
  EXPECT_THAT(line, testing::StartsWith("run,time.dt,strip.cells_across,error,seconds"));
  for (const char* start : {"1,0.05,1,", "2,0.05,2,", "3,0.025,1,", "4,0.025,2,"}) {
    std::getline(csv, line);
    EXPECT_THAT(line, testing::StartsWith(start));
  }
  EXPECT_THAT(outcome.out, HasSubstr("*"));
}
TEST_F(StudyCommand, AFileThatAScriptNamesDecidesARunToo) {
  folder.file("small.yaml", std::string(kScene).replace(std::string(kScene).find("script:\n"), 8,
                                                        "robots:\n  arm: {urdf: arm7.urdf, position: [2, 0, 0], drives: {kp: 100, kd: 5}}\n"
                                                        "script:\n  - {robot: arm, trajectory: way.csv}\n"));
  const std::string study =
      folder.file("study.yaml", "study: way\nscene: small.yaml\ngrid: {strip.cells_across: [1, 2]}\nagainst: {finest: true}\n");
  const auto seconds = [&](const std::string& to) {
    folder.file("way.csv", "time_s, arm_joint1 [rad]\n0, 0\n0.1, " + to + "\n");
    const Outcome outcome = tapesim({"study", study, "--out", (folder / "out").string()});
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    return read(folder / "out" / "study.csv");
  };
  const std::string first = seconds("0.01");
  EXPECT_EQ(seconds("0.01"), first) << "to the microsecond: nothing was run again";
  EXPECT_NE(seconds("0.02"), first);
}
TEST_F(StudyCommand, AgainstTheFinestRunMeasuresStatesOnDifferentMeshes) {
  const std::string study = folder.file("study.yaml", std::string(kStudy) + "against: {finest: true}\nmeasure: state\n");
  const Outcome outcome = tapesim({"study", study, "--out", (folder / "out").string(), "--set", "effects.gravity=on"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_THAT(read(folder / "out" / "study.csv"), HasSubstr("finest"));
}
TEST_F(StudyCommand, RunsAreComparedWithTheFinestOfTheirKind) {
  const std::string study =
      folder.file("study.yaml", std::string(kStudy) + "against: {finest: true, of_each: [time.dt]}\nmeasure: max_strain\n");
  const Outcome outcome = tapesim({"study", study, "--out", (folder / "out").string()});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  std::istringstream csv(read(folder / "out" / "study.csv"));
  std::string line;
  std::getline(csv, line);
  EXPECT_THAT(line, testing::StartsWith("run,time.dt,strip.cells_across,max_strain,error,seconds"));
  for (bool finest : {false, true, false, true}) {
    std::getline(csv, line);
    EXPECT_EQ(line.ends_with(",finest"), finest) << line;
  }
}
TEST_F(StudyCommand, ARunThatLeavesNothingToMeasureIsARowThatSaysSo) {
  const std::string study = folder.file(
      "study.yaml", "study: early\nscene: " TAPE_SOURCE_DIR
                    "/data/scenes/peel_area.yaml\ngrid: {time.duration: [0.01, 0.02]}\n"
                    "set: {strip.cells_across: 2, strip.cell_length: 0.004}\nagainst: {closed_form: kendall, angle_deg: 180}\n");
  const Outcome outcome = tapesim({"study", study, "--out", (folder / "out").string()});
  EXPECT_EQ(outcome.exit_code, 1) << outcome.err;
  EXPECT_THAT(read(folder / "out" / "study.csv"), ContainsRegex("\n1,0.01,,.*nothing was peeled\n2,0.02,,.*nothing was peeled\n"));
}
TEST_F(StudyCommand, WhereTheFinestRunFailsTheOthersAreShownAllTheSame) {
  const std::string study = folder.file("study.yaml",
                                        "study: worse\nscene: small.yaml\ngrid: {solver.max_newton: [200, 1]}\nagainst: {finest: true}\n"
                                        "set: {solver.retries: 0, solver.velocity_tol: 1.0e-9, effects.gravity: on}\n");
  const Outcome outcome = tapesim({"study", study, "--out", (folder / "out").string()});
  EXPECT_EQ(outcome.exit_code, 1) << outcome.err;
  EXPECT_THAT(read(folder / "out" / "study.csv"), ContainsRegex("\n1,200,,.*,the finest run failed\n2,1,,.*max_newton"));
}
TEST_F(StudyCommand, AMistakeInAnyRunIsFoundBeforeTheFirst) {
  const std::string study = folder.file(
      "study.yaml", "study: late\nscene: small.yaml\ngrid: {time.dt: [0.05, -1]}\nagainst: {finest: true}\nset: {time.duration: 1000}\n");
  const Outcome outcome = tapesim({"study", study, "--out", (folder / "out").string()});
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_THAT(outcome.err, HasSubstr("time.dt = -1"));
  EXPECT_EQ(folder.names("out").size(), 0u);
}
TEST_F(StudyCommand, CtrlCKeepsTheRunsThatAreDone) {
  const std::string study = folder.file(
      "study.yaml", "study: long\nscene: small.yaml\ngrid: {time.duration: [0.1, 100000]}\nagainst: {closed_form: heavy_elastica}\n");
  Program program({"study", study, "--out", (folder / "out").string()});
  ASSERT_TRUE(program.wait_for_error_text("1/2"));
  program.signal(SIGINT);
  const Outcome outcome = program.wait();
  EXPECT_EQ(outcome.exit_code, 130) << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr("interrupted after 1 of 2 runs"));
  EXPECT_THAT(read(folder / "out" / "study.csv"), HasSubstr("\n1,0.1,"));
}
TEST_F(StudyCommand, AMistakeInTheStudyExitsWithTwo) {
  for (const char* end : {"against: {closed_form: magic}\n", "against: {}\n", "against: {finest: true}\nmeasure: weight\n",
                          "against: {finest: true}\ngird: 3\n", "against: {finest: true, of_each: [time.de]}\n",
                          "against: {closed_form: capstan, angle_deg: 180}\n"}) {
    const Outcome outcome = tapesim({"study", folder.file("study.yaml", std::string(kStudy) + end), "--out", (folder / "out").string()});
    EXPECT_EQ(outcome.exit_code, 2) << end;
    EXPECT_THAT(outcome.err, HasSubstr("tapesim: ")) << end;
  }
  EXPECT_EQ(tapesim({"study", (folder / "none.yaml").string()}).exit_code, 2);
  const std::string good = folder.file("study.yaml", std::string(kStudy) + "against: {finest: true}\n");
  const Outcome both = tapesim({"study", good, "--set", "time.dt=0.01"});
  EXPECT_EQ(both.exit_code, 2);
  EXPECT_THAT(both.err, HasSubstr("a key is either of the grid or set"));
}
TEST_F(Render, CtrlCLeavesNoVideo) {
  ASSERT_EQ(tapesim({"run", scene, "--out", (folder / "a").string(), "--set", "time.duration=30"}).exit_code, 0);
  const std::vector<std::string> before = folder.names("a");
  Program program({"render", (folder / "a").string()});
  ASSERT_TRUE(program.wait_for_error_text("video: "));
  program.signal(SIGINT);
  const Outcome outcome = program.wait();
  EXPECT_EQ(outcome.exit_code, 130) << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr("no video"));
  EXPECT_EQ(folder.names("a"), before);
}
TEST_F(Render, AVideoThatCannotBeIsRefusedBeforeTheSimulation) {
  for (const char* set :
       {"video.width=161", "camera={eye: [1, 1, 1], target: [1, 1, 1]}", "camera={fx: 100, fy: 100, width: 161}",
        "camera={eye: [1, 1, 1], follow: moon}", "camera={eye: [1, 1, 1], mount: moon}", "camera={eye: [1, 1, 1], inset: {}}"}) {
    const Outcome outcome = tapesim({"run", scene, "--out", (folder / "a").string(), "--video", "--set", set});
    EXPECT_EQ(outcome.exit_code, 2) << set;
    EXPECT_EQ(folder.names("a").size(), 0u) << set;
  }
}
TEST_F(Render, MakesStillsAndAVideoFromAnyCameraAndRefusesWhatIsNotThere) {
  ASSERT_EQ(tapesim({"run", scene, "--out", (folder / "a").string()}).exit_code, 0);
  const std::string look = folder.file("look.yaml", "eye: [0.1, -0.2, 0.1]\ntarget: [0.02, 0, 0]\n");
  const std::string pinhole =
      folder.file("pinhole.yaml", "camera: {fx: 200, fy: 200, cx: 80, cy: 60, width: 160, height: 120, position: [0.02, 0, -0.2]}\n");
  const std::vector<std::string> small = {"render", (folder / "a").string(), "--width", "160", "--height", "120"};
  const auto with = [&](std::vector<std::string> more) {
    more.insert(more.begin(), small.begin(), small.end());
    return tapesim(more);
  };
  EXPECT_EQ(with({"--still", "0", "--still", "-1", "--color", "strain"}).exit_code, 0);
  EXPECT_EQ(with({"--still", "1", "--camera", look, "--color", "contact_force"}).exit_code, 0);
  EXPECT_EQ(with({"--camera", pinhole}).exit_code, 0);
  const std::string two =
      folder.file("two.yaml", "camera: [{eye: [0.1, -0.2, 0.1], follow: tape.tip}, {eye: [0, -0.3, 0], follow: tape}]\n");
  EXPECT_EQ(with({"--still", "2", "--camera", two, "--color", "part", "--track", "0.01"}).exit_code, 0);
  for (const char* bad : {"camera: {eye: [0, -1, 0], follow: moon}\n", "camera: [{fx: 200, fy: 200}, {eye: [0, -1, 0]}]\n"})
    EXPECT_EQ(with({"--still", "0", "--camera", folder.file("bad.yaml", bad)}).exit_code, 2) << bad;
  EXPECT_THAT(folder.names("a"), IsSupersetOf({"still_-1.png", "still_0.png", "still_1.png", "video.mp4"}));
  EXPECT_EQ(with({"--still", "99"}).exit_code, 2);
  EXPECT_EQ(with({"--camera", (folder / "none.yaml").string()}).exit_code, 2);
  EXPECT_EQ(with({"--camera", folder.file("bad.yaml", "eye: [0, 0, 0]\nfow: 3\n")}).exit_code, 2);
  EXPECT_EQ(tapesim({"render", (folder / "none").string()}).exit_code, 2);
}

TEST(ShippedScenes, StartSound) {
  for (const auto& entry : std::filesystem::directory_iterator(std::filesystem::path(TAPE_SOURCE_DIR) / "data" / "scenes")) {
    if (entry.path().extension() != ".yaml") continue;
    const Outcome outcome = tapesim({"check", entry.path().string()});
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  }
}

TEST(Studies, ThatShipSetWhatTheirScenesHave) {
  for (const auto& entry : std::filesystem::directory_iterator(TAPE_SOURCE_DIR "/data/studies")) {
    if (entry.path().extension() != ".yaml") continue;
    const cosim::SceneFile study = cosim::SceneFile::load(entry.path());
    if (study["replay"]) continue;  // of episodes: below
    const std::string scene = cosim::find_file(entry.path(), "scenes", study["scene"].text()).string();
    std::vector<std::string> always;
    for (const std::string& key : study["set"].keys()) always.push_back(key + "=" + study["set"][key].text());
    std::size_t most = 0;
    for (const std::string& key : study["grid"].keys()) most = std::max(most, study["grid"][key].texts().size());
    for (std::size_t k = 0; k < most; ++k) {  // the k-th values of all keys at once: each value comes up
      std::vector<std::string> arguments{"check", scene};
      for (const std::string& set : always) arguments.insert(arguments.end(), {"--set", set});
      for (const std::string& key : study["grid"].keys()) {
        const std::vector<std::string> values = study["grid"][key].texts();
        arguments.insert(arguments.end(), {"--set", key + "=" + values[std::min(k, values.size() - 1)]});
      }
      const Outcome outcome = tapesim(arguments);
      EXPECT_EQ(outcome.exit_code, 0) << testing::PrintToString(arguments) << ": " << outcome.err;
    }
  }
}

TEST(Studies, OfEpisodesThatShipFindThem) {
  const std::string plan = TAPE_SOURCE_DIR "/data/studies/stick_replay.yaml";
  const cosim::SceneFile study = cosim::SceneFile::load(plan);
  const auto episodes = study["episodes"].texts();
  EXPECT_FALSE(episodes.empty());
  for (const std::string& name : episodes) {
    const std::string file = cosim::find_file(plan, "episodes", name).string();
    const cosim::Replay replay = cosim::read_replay(cosim::SceneFile::load(file));
    EXPECT_TRUE(replay.episode.synthetic()) << file;
    EXPECT_THAT(cosim::remarks(replay.episode), testing::IsEmpty()) << file;
    for (const std::string& model : study["models"].texts()) {
      std::vector<std::string> arguments{"check", replay.scene.string(), "--model", model};
      for (const std::string& set : replay.overrides) arguments.insert(arguments.end(), {"--set", set});
      const Outcome outcome = tapesim(arguments);
      EXPECT_EQ(outcome.exit_code, 0) << file << ", " << model << ": " << outcome.err;
    }
  }
}
