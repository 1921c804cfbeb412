#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <sys/wait.h>

#include <algorithm>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>

#include "cosim/run/state_file.hpp"
#include "tape/step/stepper.hpp"
#include "tests/apps/tapesim/program.hpp"

using namespace tape::test;
using nlohmann::json;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;

namespace {
/// A short strip that falls on a table; 12 steps.
constexpr const char* kScene = R"(scene: small
film: vinyl_19mm
time: {dt: 0.01, duration: 0.12}
strip: {length: 0.04, cells_across: 2, position: [-0.02, 0, 0.003]}
bodies:
  table: {shape: box, size: [0.1, 0.1, 0.02], position: [0, 0, -0.01]}
script:
  - {grip: tape.root, as: hand}
record: {rate: 50, figures: [tip, rest_speed]}
)";

std::vector<std::string> with(std::vector<std::string> first, const std::vector<std::string>& more) {
  first.insert(first.end(), more.begin(), more.end());
  return first;
}

class Run : public testing::Test {
 protected:
  Outcome run(const std::string& out, const std::vector<std::string>& more = {}) const {
    return tapesim(with({"run", scene, "--out", (folder / out).string()}, more));
  }
  json report(const std::string& out) const { return json::parse(read(folder / out / "report.json")); }

  Folder folder;
  std::string scene = folder.file("small.yaml", kScene);
};
using BadInput = Run;
}  // namespace

TEST_F(Run, LeavesItsFourFilesAndNoOther) {
  const Outcome outcome = run("a");
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_THAT(folder.names("a"), ElementsAre("report.json", "snapshot.h5", "state.h5", "steps.csv"));
}
TEST_F(Run, FailsByNameWhereTheSceneStatesAConditionThatItDoesNotMeet) {
  const std::string stated = std::string(kScene) +
                             "conditions: [{name: tip_low, height: tape.tip, below: 0.1}, "
                             "{name: tip_high, height: tape.tip, above: 1, held: 0.05}]\n";
  scene = folder.file("stated.yaml", stated);
  const Outcome outcome = run("a");
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_THAT(outcome.out, HasSubstr("condition not met: tip_high"));
  EXPECT_THAT(outcome.out, Not(HasSubstr("tip_low")));
  std::map<std::string, json> conditions;
  const json whole = report("a");
  for (const json& c : whole["conditions"]) conditions[c["name"]] = c;
  EXPECT_EQ(conditions.at("tip_low")["met"], true);
  EXPECT_LT(conditions.at("tip_low")["value"], 0.004);
  EXPECT_EQ(conditions.at("tip_high")["met"], false);
  EXPECT_EQ(conditions.at("tip_high")["required"], "> 1 for the last 0.05 s");
  EXPECT_EQ(run("b", {"--steps", "4"}).exit_code, 0) << "not at its end";
  EXPECT_EQ(run("c", {"--set", "conditions.1.above=-1"}).exit_code, 0);
  const Outcome refused = tapesim({"check", scene, "--set", "conditions.0.height=tip"});
  EXPECT_EQ(refused.exit_code, 2);
  EXPECT_THAT(refused.err, HasSubstr("conditions.0.height = tip"));
}
TEST_F(Run, ReportHasAllKeysThatScriptsRelyOn) {
  ASSERT_EQ(run("a", {"--steps", "3"}).exit_code, 0);
  const json r = report("a");
  for (const char* key : {"status",
                          "scene",
                          "model",
                          "backend",
                          "threads",
                          "version",
                          "settings",
                          "steps",
                          "sim_time_s",
                          "wall_s",
                          "real_time_factor",
                          "step_ms",
                          "newton",
                          "linear",
                          "hessian_mode",
                          "stop_error_estimate_m",
                          "min_gap_m",
                          "intersections",
                          "energy_drift",
                          "state_hash",
                          "effects",
                          "conditions",
                          "figures"})
    EXPECT_TRUE(r.contains(key)) << key;
  for (const char* key : {"mean", "p50", "p95", "max"}) EXPECT_TRUE(r["step_ms"].contains(key)) << key;
  for (const char* key : {"mean", "max", "failed_steps"}) EXPECT_TRUE(r["newton"].contains(key)) << key;
  for (const char* key : {"solver", "iterations_mean"}) EXPECT_TRUE(r["linear"].contains(key)) << key;
  for (const char* key : {"on", "why", "ms_per_step"}) EXPECT_TRUE(r["effects"]["membrane"].contains(key)) << key;
  for (const char* key : {"name", "value", "required", "met"}) EXPECT_TRUE(r["conditions"][0].contains(key)) << key;
  EXPECT_EQ(r["status"], "done");
  EXPECT_EQ(r["steps"], 3);
  EXPECT_DOUBLE_EQ(r["sim_time_s"], 0.03);
  EXPECT_EQ(r["settings"]["time"]["dt"], 0.01);
  EXPECT_TRUE(r["figures"].contains("tip_drop_m"));
}
TEST_F(Run, HasOneRowAStepAndStatesAtTheRateAskedFor) {
  ASSERT_EQ(run("a").exit_code, 0);
  const std::string steps = read(folder / "a" / "steps.csv");
  EXPECT_EQ(std::count(steps.begin(), steps.end(), '\n'), 1 + 12);
  const cosim::StateReader states(folder / "a" / "state.h5");
  EXPECT_EQ(states.frames(), 7);  // 0, 0.02, ..., 0.12 s
  EXPECT_NEAR(states.frame(6).time, 0.12, 1e-12);
}
TEST_F(Run, ResumedEndsInTheStateAndTheFilesOfAnUninterruptedOne) {
  ASSERT_EQ(run("whole").exit_code, 0);
  ASSERT_EQ(run("parts", {"--steps", "5"}).exit_code, 0);
  ASSERT_EQ(run("parts", {"--resume", (folder / "parts" / "snapshot.h5").string()}).exit_code, 0);
  EXPECT_EQ(report("parts")["state_hash"], report("whole")["state_hash"]);
  EXPECT_EQ(report("parts")["resumed_from_step"], 5);
  const std::string steps = read(folder / "parts" / "steps.csv");
  EXPECT_EQ(std::count(steps.begin(), steps.end(), '\n'), 1 + 12);
}
/// The tip falls below 1 mm within a few steps, when nobody has said; so many later another phase begins.
TEST_F(Run, ResumedAcrossPhasesKeepsThemToTheStep) {
  const std::string phases =
      "  - {phase: fall}\n  - {wait_until: {height: tape.tip, below: 0.001}, timeout: 1}\n  - {wait: 0.02}\n  - {phase: rest}\n";
  const std::string text = kScene;
  const std::size_t record = text.find("record:");
  scene = folder.file("phases.yaml", text.substr(0, record) + phases + text.substr(record));
  ASSERT_EQ(run("whole").exit_code, 0);
  const std::string steps = read(folder / "whole" / "steps.csv");
  EXPECT_THAT(steps, testing::StartsWith("step,time_s,phase,ms,"));
  const auto phase_of_rows = [](const std::string& csv) {
    std::vector<std::string> names;
    std::istringstream lines(csv);
    std::string line;
    for (std::getline(lines, line); std::getline(lines, line);) {
      const std::size_t from = line.find(',', line.find(',') + 1) + 1;
      names.push_back(line.substr(from, line.find(',', from) - from));
    }
    return names;
  };
  const std::vector<std::string> names = phase_of_rows(steps);
  const auto falling = static_cast<int>(std::ranges::count(names, "fall"));
  ASSERT_GT(falling, 3);
  ASSERT_LT(falling, 12);
  EXPECT_EQ(std::ranges::count(names, "rest"), 12 - falling);
  for (const int stop : {falling - 2, falling - 1, falling, falling + 1}) {
    const std::string out = "parts" + std::to_string(stop);
    ASSERT_EQ(run(out, {"--steps", std::to_string(stop)}).exit_code, 0);
    ASSERT_EQ(run(out, {"--resume", (folder / out / "snapshot.h5").string()}).exit_code, 0);
    EXPECT_EQ(phase_of_rows(read(folder / out / "steps.csv")), names) << "stopped after step " << stop;
    EXPECT_EQ(report(out)["state_hash"], report("whole")["state_hash"]);
    const cosim::StateReader a(folder / "whole" / "state.h5"), b(folder / out / "state.h5");
    EXPECT_EQ(a.mesh().phases, b.mesh().phases);
    for (int i = 0, k = 0; i < a.frames(); ++i, ++k) {
      while (b.frame(k).step < a.frame(i).step) ++k;  // the state that it stopped at is recorded, too
      EXPECT_EQ(a.frame(i).phase, b.frame(k).phase) << "step " << a.frame(i).step;
    }
  }
}
TEST_F(Run, ReportsWhatEachPhaseCost) {
  scene = folder.file("phases.yaml", std::string(kScene) + "# end\n");
  const Outcome outcome = run("a", {"--set", "script=[{phase: fall}, {wait: 0.05}, {phase: rest}]"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const json phases = report("a")["phases"];
  ASSERT_EQ(phases.size(), 2u);
  for (const char* key :
       {"name", "start_s", "end_s", "steps", "wall_s", "step_ms", "newton_mean", "effects_ms_per_step", "stages_ms_per_step"})
    EXPECT_TRUE(phases[0].contains(key)) << key;
  EXPECT_EQ(phases[0]["name"], "fall");
  EXPECT_EQ(phases[0]["steps"], 5);
  EXPECT_DOUBLE_EQ(phases[0]["end_s"], 0.05);
  EXPECT_EQ(phases[1]["name"], "rest");
  EXPECT_EQ(phases[1]["steps"], 7);
  EXPECT_TRUE(phases[1]["effects_ms_per_step"].contains("membrane"));
  EXPECT_TRUE(phases[1]["stages_ms_per_step"].contains("broad_phase"));
  EXPECT_THAT(outcome.out, testing::AllOf(HasSubstr("ms/step"), HasSubstr("\nfall"), HasSubstr("\nrest")));
  ASSERT_EQ(run("b", {"--steps", "1"}).exit_code, 0);
  EXPECT_FALSE(report("b").contains("phases")) << "of a script without phases";
}
/// Beside the run the movie knows only its beginning; afterwards it is drawn from the recording.
TEST_F(Run, TheVideoIsThatOfTheRecordingAndHasAStillOfEachPhase) {
  scene = folder.file("movie.yaml", std::string(kScene) +
                                        "camera:\n  - {eye: [0.06, -0.1, 0.06], target: [0, 0, 0]}\n"
                                        "  - {eye: [0.05, -0.02, 0.02], target: [0, 0, 0], inset: {corner: top_right}}\n"
                                        "video: {width: 320, height: 180, overlay: [hand]}\n");
  const std::vector<std::string> phases{"--set", "script=[{phase: fall}, {grip: tape.root, as: hand}, {wait: 0.05}, {phase: rest}]"};
  const Outcome outcome = run("a", with(phases, {"--video"}));
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_THAT(folder.names("a"),
              ElementsAre("report.json", "snapshot.h5", "state.h5", "steps.csv", "still_fall.png", "still_rest.png", "video.mp4"));
  EXPECT_GT(report("a")["video"]["render_s"], 0);
  EXPECT_GT(report("a")["video"]["after_run_s"], 0);
  ASSERT_EQ(tapesim({"render", (folder / "a").string(), "--out", (folder / "b").string()}).exit_code, 0);
  for (const char* name : {"video.mp4", "still_fall.png", "still_rest.png"})
    EXPECT_TRUE(read(folder / "a" / name) == read(folder / "b" / name)) << name;
  ASSERT_EQ(run("c", with(phases, {"--steps", "4"})).exit_code, 0);
  ASSERT_EQ(run("c", with(phases, {"--video", "--resume", (folder / "c" / "snapshot.h5").string()})).exit_code, 0);
  EXPECT_TRUE(read(folder / "c" / "still_rest.png") == read(folder / "a" / "still_rest.png"));
  const Outcome unknown = run("d", {"--video", "--set", "video.overlay=[hnd]"});
  EXPECT_EQ(unknown.exit_code, 2);
  EXPECT_THAT(unknown.err, testing::AllOf(HasSubstr("video.overlay.0 = hnd"), HasSubstr("did you mean hand?")));
  EXPECT_EQ(tapesim({"render", (folder / "a").string(), "--overlay", "hnd"}).exit_code, 2);
}
TEST_F(BadInput, ASnapshotGoesOnOnlyWithItsTimeStep) {
  ASSERT_EQ(run("a", {"--steps", "6"}).exit_code, 0);
  const Outcome outcome = run("b", {"--resume", (folder / "a" / "snapshot.h5").string(), "--set", "time.dt=0.02"});
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_THAT(outcome.err, HasSubstr("step 6 at 0.06 s does not fit time.dt = 0.02"));
}
TEST_F(Run, ThreadsDoNotChangeABit) {
  ASSERT_EQ(run("one", {"--threads", "1"}).exit_code, 0);
  for (const char* threads : {"2", "8"}) {
    ASSERT_EQ(run("more", {"--threads", threads}).exit_code, 0);
    EXPECT_EQ(report("more")["state_hash"], report("one")["state_hash"]) << threads << " threads";
    EXPECT_EQ(report("more")["threads"], std::stoi(threads));
  }
}
/// An arm whose fingers close on the end of a tape and begin to lift its roll.
TEST_F(Run, WithAnArmNeitherThreadsNorAResumeChangeABit) {
  scene = TAPE_SOURCE_DIR "/data/scenes/arm_swing.yaml";
  ASSERT_EQ(run("whole", {"--threads", "1", "--steps", "45"}).exit_code, 0);
  ASSERT_EQ(run("parts", {"--threads", "8", "--steps", "20"}).exit_code, 0);
  ASSERT_EQ(run("parts", {"--threads", "2", "--steps", "25", "--resume", (folder / "parts" / "snapshot.h5").string()}).exit_code, 0);
  EXPECT_EQ(report("parts")["state_hash"], report("whole")["state_hash"]);
  EXPECT_GT(report("whole")["figures"]["link_force_max_N.station:right_finger1_link4"].get<double>(), 1) << "it holds the tape";
}
TEST_F(Run, ASettingFromOutsideReplacesTheSceneFiles) {
  ASSERT_EQ(run("a", {"--steps", "1", "--set", "strip.length=0.03", "--set", "solver.velocity_tol=1e-4"}).exit_code, 0);
  EXPECT_EQ(report("a")["settings"]["strips"]["tape"]["length"], 0.03);
  EXPECT_EQ(report("a")["settings"]["solver"]["velocity_tol"], 1e-4);
  EXPECT_EQ(report("a")["settings"]["contact"]["dhat"], 1.8e-4) << "that of the film, where the scene gives none";
  EXPECT_EQ(report("a")["settings"]["strips"]["tape"]["cell_length"], 0.01) << "whole cells: 30 mm over 9.5 mm is 3";
}
TEST_F(Run, CtrlCEndsTheStepWritesEverythingAndSaysHowToGoOn) {
  Program program({"run", scene, "--out", (folder / "a").string(), "--set", "time.duration=1000"});
  ASSERT_TRUE(program.wait_for_error_text("run: "));
  program.signal(SIGINT);
  const Outcome outcome = program.wait();
  EXPECT_EQ(outcome.exit_code, 130) << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr("--resume"));
  EXPECT_THAT(folder.names("a"), ElementsAre("report.json", "snapshot.h5", "state.h5", "steps.csv"));
  EXPECT_EQ(report("a")["status"], "interrupted");
}

TEST_F(BadInput, AMissingSceneIsNamed) {
  const Outcome outcome = tapesim({"run", "/nowhere/scene.yaml"});
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_THAT(outcome.err, HasSubstr("/nowhere/scene.yaml"));
}
TEST_F(BadInput, AnUnknownKeyIsNamedWithItsLine) {
  const Outcome outcome = tapesim({"run", folder.file("bad.yaml", std::string(kScene) + "stripes: 3\n"), "--out", (folder / "a").string()});
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_THAT(outcome.err, HasSubstr("bad.yaml:10"));
  EXPECT_THAT(outcome.err, HasSubstr("stripes"));
  EXPECT_FALSE(std::filesystem::exists(folder / "a"));
}
TEST_F(BadInput, ASettingOutOfItsRangeIsNamedWithWhatIsAllowed) {
  for (const char* set : {"time.dt=-1", "time.dt=nan", "strip.cells_across=many", "contact.dhat", "effects.glue=true",
                          "solver.linear=magic", "record.figures=[weight]"}) {
    const Outcome outcome = run("a", {"--set", set});
    EXPECT_EQ(outcome.exit_code, 2) << set;
    EXPECT_THAT(outcome.err, HasSubstr("tapesim: ")) << set;
    EXPECT_FALSE(std::filesystem::exists(folder / "a")) << set;
  }
  EXPECT_THAT(run("a", {"--set", "time.dt=-1"}).err, testing::AllOf(HasSubstr("time.dt"), HasSubstr("(0, 1]"), HasSubstr("s")));
}
TEST_F(BadInput, AFigureThatTheSceneHasNotIsNamedWithItsLine) {
  const Outcome unknown = run("a", {"--set", "record.figures=[weight]"});
  EXPECT_THAT(unknown.err, testing::AllOf(HasSubstr("--set: record.figures = [weight]"), HasSubstr("rest_speed")));
  const Outcome unfit =
      tapesim({"check", folder.file("bad.yaml", std::string(kScene) + "# 10\n"), "--set", "record.figures=[capstan_ratio]"});
  EXPECT_EQ(unfit.exit_code, 2);
  EXPECT_THAT(unfit.err, HasSubstr("fewer than two grips"));
}
TEST_F(BadInput, ACommandThatThereIsNotIsNamedWithThoseThereAre) {
  const Outcome wrong = tapesim({"rum"}), none = tapesim({"fly"});
  EXPECT_THAT(wrong.err, HasSubstr("rum: no such command; did you mean run?"));
  EXPECT_THAT(none.err, testing::AllOf(HasSubstr("fly: no such command"), HasSubstr("check, explain, info, render, replay, run, study")));
  for (const Outcome& outcome : {wrong, none}) EXPECT_EQ(outcome.exit_code, 2);
}
TEST_F(BadInput, AnOutputThatCannotBeWrittenIsAnError) {
  EXPECT_EQ(WEXITSTATUS(std::system((std::string(TAPESIM) + " info > /dev/full 2> /dev/null").c_str())), 2);
}
TEST_F(BadInput, AWrongCommandLineExitsWithTwo) {
  EXPECT_EQ(tapesim({}).exit_code, 2);
  EXPECT_EQ(tapesim({"run"}).exit_code, 2);
  EXPECT_EQ(run("a", {"--backend", "abacus"}).exit_code, 2);
  EXPECT_EQ(run("a", {"--steps", "-3"}).exit_code, 2);
  EXPECT_EQ(run("a", {"--steps", "1000000000000"}).exit_code, 2);
  EXPECT_EQ(tapesim({"run", "--help"}).exit_code, 0);
}
TEST_F(BadInput, AnIntersectingStartIsRefusedByCheckAndRun) {
  const std::vector<std::string> sunk = {"--set", "strip.position=[-0.02, 0, -0.001]", "--set", "strip.rotation_deg=[0, -20, 0]"};
  const Outcome outcome = tapesim(with({"check", scene}, sunk));
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_THAT(outcome.err, testing::AllOf(HasSubstr("tape"), HasSubstr("table")));
  EXPECT_EQ(run("a", sunk).exit_code, 2);
  EXPECT_FALSE(std::filesystem::exists(folder / "a"));
}
TEST_F(BadInput, ATruncatedOrForeignSnapshotIsRefused) {
  ASSERT_EQ(run("a", {"--steps", "2"}).exit_code, 0);
  const std::string whole = read(folder / "a" / "snapshot.h5");
  for (std::size_t bytes : {std::size_t{0}, whole.size() / 3, whole.size() - 64}) {
    const Outcome outcome = run("b", {"--resume", folder.file("cut.h5", whole.substr(0, bytes))});
    EXPECT_EQ(outcome.exit_code, 2) << bytes;
    EXPECT_THAT(outcome.err, HasSubstr("cut.h5")) << bytes;
  }
  for (const char* other : {"strip.cells_across=3", "bodies.table.size=[0.1, 0.12, 0.02]"})
    EXPECT_EQ(run("b", {"--resume", (folder / "a" / "snapshot.h5").string(), "--set", other}).exit_code, 2) << other;
  EXPECT_EQ(run("b", {"--resume", (folder / "none.h5").string()}).exit_code, 2);
  EXPECT_FALSE(std::filesystem::exists(folder / "b"));
}
TEST_F(BadInput, ASnapshotOfTheEndLeavesNothingToRunAndItsReportAsItIs) {
  ASSERT_EQ(run("a").exit_code, 0);
  const std::string before = read(folder / "a" / "report.json"), snapshot = (folder / "a" / "snapshot.h5").string();
  const Outcome again = run("a", {"--resume", snapshot});
  EXPECT_EQ(again.exit_code, 2);
  EXPECT_THAT(again.err, testing::AllOf(HasSubstr("snapshot.h5"), HasSubstr("0.12"), HasSubstr("nothing is left to run")));
  EXPECT_EQ(read(folder / "a" / "report.json"), before);
  EXPECT_EQ(run("a", {"--resume", snapshot, "--set", "time.duration=0.14"}).exit_code, 0);
}
TEST_F(BadInput, AnOptionWithoutAValueIsNotAnOptionLeftOut) {
  for (const char* option : {"--resume", "--out", "--model", "--record"}) {
    const Outcome outcome = tapesim({"run", scene, option, ""});
    EXPECT_EQ(outcome.exit_code, 2) << option;
    EXPECT_THAT(outcome.err, HasSubstr(std::string(option) + ": the value is empty"));
  }
}
TEST_F(BadInput, ACameraThatFollowsNothingIsFoundByCheck) {
  for (const auto& [camera, says] :
       {std::pair("{eye: [0, -1, 1], follow: tabel}", "follow = tabel: no thing"), {"{fx: 600, mount: arm}", "mount = arm: no body"}}) {
    const Outcome outcome = tapesim({"check", folder.file("seen.yaml", std::string(kScene) + "camera: " + camera + "\n")});
    EXPECT_EQ(outcome.exit_code, 2) << camera;
    EXPECT_THAT(outcome.err, testing::AllOf(HasSubstr("seen.yaml"), HasSubstr("camera"), HasSubstr(says)));
  }
}
TEST_F(BadInput, AFullDiskLeavesNothingHalfWritten) {
  for (long bytes : {500L, 5000L, 20000L}) {
    Program program({"run", scene, "--out", (folder / "a").string()}, {.file_bytes = bytes});
    const Outcome outcome = program.wait();
    EXPECT_EQ(outcome.exit_code, 2) << bytes << " bytes: " << outcome.err;
    EXPECT_THAT(outcome.err, HasSubstr((folder / "a").string())) << bytes;
    EXPECT_THAT(folder.names("a"), Not(Contains("report.json"))) << bytes;
    for (const std::string& name : folder.names("a"))
      EXPECT_THAT(name, testing::AnyOf("snapshot.h5", "state.h5", "steps.csv")) << "half written";
  }
}
TEST_F(Run, AStepThatCannotBeSolvedEndsTheRunAtTheLastGoodState) {
  const Outcome outcome = run("a", {"--set", "solver.max_newton=1", "--set", "solver.retries=0"});
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_EQ(report("a")["status"], "failed");
  EXPECT_EQ(report("a")["newton"]["failed_steps"], 1);
  EXPECT_THAT(read(folder / "a" / "report.json"), HasSubstr("solver.max_newton"));
  ASSERT_EQ(run("b", {"--resume", (folder / "a" / "snapshot.h5").string()}).exit_code, 0);
  ASSERT_EQ(run("whole").exit_code, 0);
  EXPECT_EQ(report("b")["state_hash"], report("whole")["state_hash"]);
}
TEST_F(BadInput, AFolderThatCannotBeMadeIsNamed) {
  const Outcome outcome = tapesim({"run", scene, "--out", "/dev/full/run"});
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_THAT(outcome.err, HasSubstr("/dev/full"));
}
TEST_F(BadInput, CudaWithoutADeviceIsRefusedInASentence) {
  if (tape::cuda_available()) GTEST_SKIP() << "a device answers";
  const Outcome outcome = run("a", {"--backend", "cuda"});
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_THAT(outcome.err, HasSubstr("no CUDA device answers"));
  EXPECT_FALSE(std::filesystem::exists(folder / "a"));
}
