#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstring>
#include <limits>
#include <memory>
#include <optional>

#include "apps/movie/things.hpp"
#include "apps/report/phase_table.hpp"
#include "apps/report/table.hpp"
#include "apps/tapesim/episode_recorder.hpp"
#include "apps/tapesim/interrupt.hpp"
#include "apps/tapesim/progress.hpp"
#include "apps/tapesim/recorded_run.hpp"
#include "apps/tapesim/settings_list.hpp"
#include "cosim/exchange/exchange.hpp"
#include "tape/core/execution.hpp"
#include "tape/core/stopwatch.hpp"

namespace tape::tapesim {
namespace {
struct RunArguments {
  SceneArguments scene;
  std::string out, resume, record, backend = "auto";
  int steps = -1, threads = 0;
  bool video = false;
};

void print_summary(const cosim::RunSummary& s, const RunFolder& folder) {
  using report::rounded;
  fmt::print("{}: {} steps, {} s simulated in {} s ({} ms a step), Newton {} a step, linear solver {}\n", s.status, s.steps,
             rounded(s.sim_time), rounded(s.wall), rounded(s.step_ms.mean), rounded(s.newton_mean),
             s.linear_solver.empty() ? "none" : s.linear_solver);
  if (!s.failure.empty()) fmt::print("failed at {}\n", s.failure);
  if (!s.phases.empty()) fmt::print("{}", report::to_text(report::phase_table(s.phases)));
  for (const auto& [name, value] : s.figures) fmt::print("  {} = {}\n", name, rounded(value));
  for (const cosim::Condition& c : s.conditions)
    if (!c.met) fmt::print("  condition not met: {} = {} (required: {})\n", c.name, rounded(c.value), c.required);
  fmt::print("  state {}, files in {}\n", s.state_hash, folder.path().string());
}

/// A word of a command line as a shell wants it.
std::string shell_word(const std::string& text) {
  const auto plain = [](unsigned char c) { return std::isalnum(c) || std::strchr("/._-+=,:", c); };
  if (!text.empty() && std::all_of(text.begin(), text.end(), plain)) return text;
  std::string word = "'";
  for (char c : text) word += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return word + "'";
}

void print_how_to_resume(const RunArguments& arguments, const State& state, const RunFolder& folder) {
  std::string options;
  for (const std::string& one : arguments.scene.overrides) options += " --set " + shell_word(one);
  if (!arguments.scene.model.empty()) options += " --model " + arguments.scene.model;
  if (arguments.backend != "auto") options += " --backend " + arguments.backend;
  if (arguments.video) options += " --video";
  fmt::print("stopped after step {}. To go on:\n  tapesim run {} --resume {} --out {}{}\n", state.step, shell_word(arguments.scene.scene),
             shell_word((folder / "snapshot.h5").string()), shell_word(folder.path().string()), options);
}

/// Ends the movie that was begun with the run; where there is none, or where it could not be kept up, makes that of the recording. The
/// report gets the times that it took.
/// @return false if interrupted
bool end_video(const LoadedWorld& loaded, const RunFolder& folder, std::optional<movie::LiveMovie>& live, report::Json& json) {
  bool beside = false, made = false;
  Real waited_ms = 0;
  {
    const Stopwatch watch(waited_ms);
    beside = live && live->finish(watched_video()) == movie::LiveMovie::End::made;
    made = beside || (!interrupted() && movie::write_video(cosim::StateReader(folder / "state.h5"), loaded.input.pictures,
                                                           folder / "video.mp4", watched_video()));
  }
  if (!made) {
    fmt::print("interrupted: no video. To make it:\n  tapesim render {}\n", shell_word(folder.path().string()));
    return false;
  }
  json["video"] = {{"render_s", beside ? live->seconds() : 1e-3 * waited_ms}, {"after_run_s", 1e-3 * waited_ms}};
  write_report(folder, json);
  return true;
}

/// A step ends at (step + 1) dt, so that a snapshot goes on with the dt that it was made with.
State resumed(const std::string& file, const World& world) {
  State state = load_snapshot(file, world);
  const Real dt = world.setup.scene.time.dt;
  if (std::abs(state.time - state.step * dt) > 1e-6 * dt)
    throw InputError(fmt::format("{}: step {} at {} s does not fit time.dt = {}; a run goes on with the dt that it began with", file,
                                 state.step, to_text(state.time), to_text(dt)));
  return state;
}

int run(const RunArguments& arguments) {
  set_threads(arguments.threads);
  const Backend backend = backend_of(arguments.backend);
  LoadedWorld loaded = load_world(arguments.scene, Rolls::settle);
  if (arguments.video) movie::require_video(loaded.input.pictures);
  const std::unique_ptr<Stepper> stepper = cosim::make_stepper(backend, loaded.world, loaded.input.run.robots);
  State state = arguments.resume.empty() ? State::start(loaded.world) : resumed(arguments.resume, loaded.world);
  if (!arguments.resume.empty()) {
    loaded.world = loaded.world.with(state.remnants);
    stepper->renew(state);
  }
  const int first_step = state.step, planned = cosim::planned_steps(loaded.world.setup.scene) - first_step;
  if (!arguments.resume.empty() && planned <= 0)
    throw InputError(fmt::format("{}: the state at {} s is the end of the scene or beyond (time.duration = {}): nothing is left to run",
                                 arguments.resume, to_text(state.time), to_text(loaded.world.setup.scene.time.duration)));
  std::optional<EpisodeRecorder> recorder;
  if (!arguments.record.empty()) recorder.emplace(arguments.record, arguments.scene, loaded, *stepper, state);
  RunFolder folder(arguments.out.empty() ? "out/" + loaded.world.setup.scene.name : arguments.out, loaded.world, loaded.input.run.robots,
                   loaded.input.run.phases, state, movie::pictures_text(loaded.input.pictures));
  std::optional<movie::LiveMovie> live;
  if (arguments.video && first_step == 0) folder.show(live.emplace(loaded.input.pictures, folder / "video.mp4"));
  remember_interrupts();
  const cosim::RunLog log = [&] {
    Progress progress("run", arguments.steps < 0 ? planned : std::min(planned, arguments.steps));
    return simulate_into(folder, loaded, *stepper, state, arguments.steps, [&](const State& now, const cosim::StepRow& row) {
      if (recorder) recorder->add(now);
      const std::string phase = row.phase < 0 ? "" : loaded.input.run.phases[static_cast<std::size_t>(row.phase)].name + ", ";
      progress.update(now.step - first_step, fmt::format("{}t {:.3f} s, {:.1f} ms/step", phase, now.time, row.report.wall_ms));
    });
  }();
  const cosim::RunSummary summary = cosim::summarize(loaded.world, log, loaded.input.run.figures);
  const report::Provenance provenance{arguments.scene.scene, TAPE_VERSION, runs_on_cuda(backend, loaded.world) ? "cuda" : "cpu", threads(),
                                      first_step};
  report::Json json = commit_run(folder, state, loaded, provenance, summary);
  if (recorder && log.failure.empty() && !log.interrupted) recorder->commit();
  print_summary(summary, folder);
  if (log.interrupted) print_how_to_resume(arguments, state, folder);
  const bool filmed = log.interrupted || !arguments.video || end_video(loaded, folder, live, json);
  return !log.failure.empty() || summary.fell_short ? kFailed : log.interrupted || !filmed ? kInterrupted : kDone;
}
}  // namespace

void add_run(CLI::App& app, Action& chosen) {
  auto arguments = std::make_shared<RunArguments>();
  CLI::App* command = app.add_subcommand("run", "simulates a scene");
  add_scene(*command, arguments->scene);
  command->add_option("--out", arguments->out,
                      "folder for report.json, steps.csv, state.h5, snapshot.h5, video.mp4 (default: out/<scene>)");
  command->add_option("--steps", arguments->steps, "at most so many steps now")->check(CLI::Range(0, std::numeric_limits<int>::max()));
  command->add_option("--backend", arguments->backend, "auto, cpu or cuda")->check(CLI::IsMember({"auto", "cpu", "cuda"}));
  command->add_option("--threads", arguments->threads, "threads of the CPU back end; 0: all cores. Results do not depend on it")
      ->check(CLI::Range(0, 1024));
  command->add_flag("--video", arguments->video, "also make video.mp4");
  command
      ->add_option("--record", arguments->record,
                   "also writes the motion of the robots and what the scene's calibrated cameras see of the hub as a synthetic episode: "
                   "FILE.h5, and FILE.yaml to replay it")
      ->excludes(command->add_option("--resume", arguments->resume, "goes on from a snapshot.h5 of the same scene"));
  command->footer([] { return "Settings of a scene:\n" + settings_text(); });
  command->callback([arguments, &chosen] { chosen = [arguments] { return run(*arguments); }; });
}
}  // namespace tape::tapesim
