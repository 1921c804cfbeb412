#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <fstream>
#include <limits>
#include <memory>
#include <nlohmann/json.hpp>
#include <set>

#include "apps/tapesim/interrupt.hpp"
#include "apps/tapesim/progress.hpp"
#include "apps/tapesim/replay_pictures.hpp"
#include "apps/tapesim/replay_table.hpp"
#include "apps/video/video.hpp"
#include "cosim/run/new_file.hpp"
#include "tape/core/execution.hpp"

namespace tape::tapesim {
namespace {
namespace fs = std::filesystem;

struct ReplayArguments {
  std::string file, out, model, record, backend = "auto";
  std::vector<std::string> overrides;
  int threads = 0, repeats = 0;
  bool start = false, video = false;
  std::vector<double> stills;
};

/// An episode with a model, not yet run.
struct Case {
  fs::path episode;
  std::string model;
};

/// A run that is to be made, or was made before.
struct Slot {
  Case what;
  std::string key;
  ReplayRun run;
  int steps = 0;
  bool done = false;
};

/// Whether what a folder holds of a run is of this one.
bool holds(const fs::path& folder, const ReplayRun& run) {
  std::ifstream in(folder / "report.json");
  const auto report = nlohmann::json::parse(in, nullptr, false);
  return report.is_object() && report.value("state_hash", "") == run.state_hash;
}

/// The runs of a plan, and what of them is kept from before.
class ReplayGrid {
 public:
  /// Loads every combination: what is wrong with any is found before the first run.
  /// @param pictures  they are to be drawn of the runs, whose folders must hold them
  ReplayGrid(ReplayPlan plan, fs::path folder, Backend backend, bool pictures)
      : plan_(std::move(plan)), folder_(std::move(folder)), backend_(backend), pictures_(pictures), store_(folder_ / "runs.json") {
    std::set<std::string> names;
    for (const fs::path& episode : plan_.episodes) {
      bool first = true;
      for (const std::string& model : plan_.models) {
        const LoadedReplay loaded = load_replay(episode, model, plan_.overrides);
        if (first && !names.insert(loaded.replay.name).second)
          throw InputError(episode.string() + ": another episode is named " + loaded.replay.name + ", too");
        if (first && pictures_) require_pictures(loaded.replay);
        if (std::exchange(first, false)) introduce(loaded);
        add(loaded, {episode, model});
      }
    }
  }

  /// @param record  FILE.h5 that the run becomes an episode in; empty: none  @return false if interrupted
  bool run(const std::string& record) {
    if (!record.empty() && slots_.size() != 1)
      throw InputError("--record: one episode, one model and one repeat make an episode, not more");
    if (!record.empty() && slots_.front().done) start_anew(slots_.front());
    cosim::make_folder(folder_);
    remember_interrupts();
    Progress progress("replay " + plan_.name, steps_);
    for (Slot& slot : slots_) {
      if (slot.done) continue;
      LoadedReplay loaded = load_replay(slot.what.episode, slot.what.model, plan_.overrides);
      const std::string what = fmt::format("{} {} {}", slot.run.episode, slot.run.model, slot.run.repeat);
      const OnStep on_step = [&](const State& now, const cosim::StepRow& row) {
        progress.update(++steps_made_, fmt::format("{}, t {:.2f} s, {:.0f} ms/step", what, now.time, row.report.wall_ms));
      };
      if (!simulate_replay(loaded, folder_of(slot.run), record, backend_, on_step, slot.run)) return false;
      keep(store_, slot.key, slot.run);
      slot.done = true;
    }
    return true;
  }

  ReplayResults results() const {
    ReplayResults results = so_far_;
    for (const Slot& slot : slots_)
      if (slot.done) results.runs.push_back(slot.run);
    return results;
  }
  /// Writes start_EPISODE_MODEL.png of each combination, without simulating.
  void draw_starts() const {
    cosim::make_folder(folder_);
    for (const Slot& slot : slots_) {
      if (slot.run.repeat > 1) continue;
      LoadedReplay loaded = load_replay(slot.what.episode, slot.what.model, plan_.overrides);
      const fs::path file = folder_ / fmt::format("start_{}_{}.png", slot.run.episode, slot.run.model);
      render::write_png(file, start_picture(loaded));
      fmt::print("{}\n", file.string());
    }
  }
  /// Of each episode the first run of each model, side by side.  @param stills  [s]  @return false if interrupted
  bool draw(const std::vector<double>& stills, bool video) const {
    for (const std::string& episode : so_far_.episodes) {
      std::optional<ReplayPictures> pictures;
      for (const Slot& slot : slots_) {
        if (slot.run.episode != episode || slot.run.repeat > 1) continue;
        if (!pictures) pictures.emplace(load_replay(slot.what.episode, slot.what.model, plan_.overrides));
        pictures->add(slot.run, folder_of(slot.run));
      }
      for (double time : stills) {
        const fs::path file = folder_ / episode / fmt::format("still_{:g}.png", time);
        render::write_png(file, pictures->at(time));
        fmt::print("{}\n", file.string());
      }
      if (!video) continue;
      const fs::path file = folder_ / episode / "video.mp4";
      if (!pictures->write_video(file, watched_video())) return false;
      fmt::print("{}\n", file.string());
    }
    return true;
  }
  std::size_t size() const { return slots_.size(); }
  const ReplayPlan& plan() const { return plan_; }

 private:
  void start_anew(Slot& slot) {
    ReplayRun fresh;
    fresh.episode = slot.run.episode, fresh.model = slot.run.model, fresh.repeat = slot.run.repeat;
    slot.run = fresh;
    slot.done = false;
    steps_ += slot.steps;
  }
  void introduce(const LoadedReplay& loaded) {
    const cosim::Replay& replay = loaded.replay;
    so_far_.episodes.push_back(replay.name);
    if (replay.episode.synthetic()) so_far_.synthetic.insert(replay.name);
    so_far_.lead_in = std::max(so_far_.lead_in, replay.params.lead_in);
    fmt::print("{}: {}\n", replay.name, replay.episode.origin.empty() ? "of unknown origin" : replay.episode.origin);
    for (const std::string& remark : cosim::remarks(replay.episode)) fmt::print("{}: note: {}\n", replay.name, remark);
  }
  void add(const LoadedReplay& loaded, const Case& what) {
    const std::string model = loaded.model();
    if (std::ranges::find(so_far_.models, model) == so_far_.models.end()) so_far_.models.push_back(model);
    if (what.model == plan_.baseline) so_far_.baseline = model;
    for (int repeat = 1; repeat <= plan_.repeats; ++repeat) {
      Slot slot{.what = what, .key = key_of(loaded, repeat, backend_), .run = {}};
      slot.run.episode = loaded.replay.name, slot.run.model = model, slot.run.repeat = repeat;
      slot.steps = cosim::planned_steps(loaded.loaded.world.setup.scene);
      slot.done = find(store_, slot.key, loaded.replay, slot.run);
      if (!slot.done || (pictures_ && !holds(folder_of(slot.run), slot.run))) start_anew(slot);
      slots_.push_back(std::move(slot));
    }
  }

  fs::path folder_of(const ReplayRun& run) const { return folder_ / run.episode / run.model / std::to_string(run.repeat); }

  ReplayPlan plan_;
  fs::path folder_;
  Backend backend_;
  bool pictures_;
  RunStore store_;
  std::vector<Slot> slots_;
  ReplayResults so_far_{};  // without its runs
  int steps_ = 0, steps_made_ = 0;
};

ReplayPlan planned(const ReplayArguments& arguments) {
  ReplayPlan plan = load_plan(arguments.file);
  if (!arguments.model.empty()) plan.models = {arguments.model}, plan.baseline = arguments.model;
  if (arguments.repeats > 0) plan.repeats = arguments.repeats;
  plan.overrides.insert(plan.overrides.end(), arguments.overrides.begin(), arguments.overrides.end());
  return plan;
}

void print_results(const ReplayPlan& plan, const ReplayResults& results) {
  fmt::print(
      "replay {}: error of the hub's landmark in the undistorted picture, from {} s on; mean over the frames of a run, its repeats, "
      "then the episodes; 95 % by bootstrap over the episodes; reduction against {}\n",
      plan.name, report::rounded(results.lead_in), results.baseline);
  if (results.synthetic.size() == results.episodes.size())
    fmt::print("The episodes are synthetic: a simulation played the real world. No robot was recorded.\n");
  else if (!results.synthetic.empty())
    fmt::print("Synthetic, with a simulation in the place of the real world: {}.\n", fmt::join(results.synthetic, ", "));
  fmt::print("{}", report::to_text(model_table(plan, results, report::rounded)));
  for (const ReplayRun& run : results.runs)
    if (!run.failure.empty()) fmt::print("  {} {} {} failed at {}\n", run.episode, run.model, run.repeat, run.failure);
}

int replay(const ReplayArguments& arguments) {
  set_threads(arguments.threads);
  if (arguments.video) video::require_ffmpeg();
  ReplayPlan plan = planned(arguments);
  const fs::path folder = arguments.out.empty() ? "out/" + plan.name : arguments.out;
  const bool pictures = arguments.start || arguments.video || !arguments.stills.empty();
  ReplayGrid grid(std::move(plan), folder, backend_of(arguments.backend), pictures);
  if (arguments.start) {
    grid.draw_starts();
    return kDone;
  }
  const bool whole = grid.run(arguments.record);
  const ReplayResults results = grid.results();
  if (!whole) fmt::print("interrupted after {} of {} runs; to go on, give the same command again\n", results.runs.size(), grid.size());
  if (results.runs.empty()) return kInterrupted;
  print_results(grid.plan(), results);
  cosim::write_text(folder / "replay.csv", report::to_csv(model_table(grid.plan(), results, tape::to_text)));
  cosim::write_text(folder / "runs.csv", report::to_csv(run_table(results)));
  cosim::write_text(folder / "frames.csv", report::to_csv(frame_table(results)));
  fmt::print("{}\n", (folder / "{replay,runs,frames}.csv").string());
  if (const auto page = replay_page(results); !page.empty()) {
    report::write_page(page, folder / "replay");
    fmt::print("{}\n", (folder / "replay.{png,svg}").string());
  }
  if (!whole) return kInterrupted;
  if (pictures && !grid.draw(arguments.stills, arguments.video)) {
    fmt::print("interrupted: no video; to make it, give the same command again\n");
    return kInterrupted;
  }
  const bool failed = std::ranges::any_of(results.runs, [](const ReplayRun& run) { return !run.failure.empty(); });
  return failed ? kFailed : kDone;
}
}  // namespace

void add_replay(CLI::App& app, Action& chosen) {
  auto arguments = std::make_shared<ReplayArguments>();
  CLI::App* command =
      app.add_subcommand("replay", "moves the robots of a scene as recorded, and scores the simulated tape in the pictures of a camera");
  command->add_option("EPISODE", arguments->file, "EPISODE.yaml, or a file that names several, models and repeats (YAML)")->required();
  command->add_option("--out", arguments->out, "folder for replay.csv, runs.csv, frames.csv and that of each run (default: out/<name>)");
  command->add_option("--set", arguments->overrides, "set a key of the scene in every run; may be repeated")->allow_extra_args(false);
  command->add_option("--model", arguments->model, "this model alone: coh-f, bond-f, coh-r or bond-r");
  command->add_option("--repeats", arguments->repeats, "runs of each episode with each model")->check(CLI::Range(1, 100));
  CLI::Option* record =
      command->add_option("--record", arguments->record, "also writes the run as a synthetic episode, FILE.h5 and FILE.yaml, as run does");
  CLI::Option* start = command->add_flag(
      "--start", arguments->start,
      "no run: pictures of the start as the camera sees it, over the recorded photograph where there is one, to check that "
      "all stands where it stood");
  CLI::Option* video = command->add_flag("--video", arguments->video,
                                         "also makes a video of each episode: photographs and models side by side, with landmarks");
  CLI::Option* still = command->add_option("--still", arguments->stills, "likewise a PNG at this time in s; may be repeated")
                           ->check(CLI::NonNegativeNumber)
                           ->allow_extra_args(false);
  start->excludes(video)->excludes(still)->excludes(record);
  command->add_option("--backend", arguments->backend, "auto, cpu or cuda")->check(CLI::IsMember({"auto", "cpu", "cuda"}));
  command->add_option("--threads", arguments->threads, "threads of the CPU back end; 0: all cores")->check(CLI::Range(0, 1024));
  command->callback([arguments, &chosen] { chosen = [arguments] { return replay(*arguments); }; });
}
}  // namespace tape::tapesim
