#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>
#include <map>
#include <memory>

#include "apps/report/plot.hpp"
#include "apps/report/table.hpp"
#include "apps/tapesim/interrupt.hpp"
#include "apps/tapesim/progress.hpp"
#include "apps/tapesim/recorded_run.hpp"
#include "apps/tapesim/study_store.hpp"
#include "cosim/exchange/exchange.hpp"
#include "cosim/run/new_file.hpp"
#include "cosim/run/summary.hpp"
#include "tape/core/execution.hpp"
#include "tape/core/hash.hpp"

namespace tape::tapesim {
namespace {
LoadedWorld load_combination(const Study& study, const std::vector<std::string>& values) {
  SceneArguments arguments{.scene = study.scene.string(), .overrides = study.overrides, .model = {}};
  for (std::size_t k = 0; k < values.size(); ++k) arguments.overrides.push_back(study.grid[k].first + "=" + values[k]);
  return load_world(arguments, Rolls::settle);
}

/// Of all that decides the outcome of a run, and its time.
std::string key_of(const Study& study, const std::vector<std::string>& values, const LoadedWorld& loaded, const State& start) {
  Hash hash;
  hash.add_file(study.scene);
  for (const auto& lines : {study.overrides, values}) hash.add(fmt::format("{}\n", fmt::join(lines, "\n")));
  hash.add(fmt::format("{} {}\n", study.reference.measure, study.reference.angle));
  add_run(hash, loaded, start, Backend::cpu);
  return hash.text();
}

/// Runs a combination, unless it is kept. A numerical failure is a result; bad input is an error of the study.
StudyRun run_one(const Study& study, const std::vector<std::string>& values, const StudyStore& store) {
  StudyRun result;
  result.values = values;
  LoadedWorld loaded = load_combination(study, values);
  State state = State::start(loaded.world);
  const std::string key = key_of(study, values, loaded, state);
  if (store.find(key, result)) return result;
  const std::unique_ptr<Stepper> stepper = cosim::make_stepper(Backend::cpu, loaded.world, loaded.input.run.robots);
  cosim::RunOptions options{.record = loaded.input.run.record, .events = loaded.input.run.events, .goals = loaded.input.run.goals};
  options.stop_asked = interrupted;
  const cosim::RunLog log = simulate(loaded.world, *stepper, state, options);
  result.take(summarize(loaded.world, log, {}));
  if (log.interrupted) return result;
  try {
    if (result.measurable()) result.measured = measure(study.reference, loaded.world, log);
  } catch (const NothingMeasured& nothing) {
    result.failure = nothing.what();
  }
  store.keep(key, result);
  return result;
}

/// Runs that are compared with one another, in order: those that agree in the keys of `of_each`.
std::vector<std::vector<StudyRun*>> groups_of(const Study& study, std::vector<StudyRun>& runs) {
  std::map<std::vector<std::string>, std::vector<StudyRun*>> by_values;
  for (StudyRun& run : runs) {
    std::vector<std::string> values;
    for (std::size_t key : study.reference.of_each) values.push_back(run.values[key]);
    by_values[values].push_back(&run);
  }
  std::vector<std::vector<StudyRun*>> groups;
  for (auto& [values, group] : by_values) groups.push_back(std::move(group));
  return groups;
}

void find_errors(const Study& study, std::vector<StudyRun>& runs) {
  const bool finest = study.reference.kind == Reference::Kind::finest;
  for (const std::vector<StudyRun*>& group : groups_of(study, runs)) {
    StudyRun& last = *group.back();
    last.finest = finest && last.measurable();
    std::vector<Real> seconds, errors;
    for (StudyRun* run : group) {
      if (run->measurable() && run != &last && last.finest) {
        run->error = distance(study.reference, run->measured, last.measured);
        run->turn_error = turn_distance(run->measured, last.measured);
      }
      if (run->measurable() && !finest) run->error = run->measured.error;
      seconds.push_back(run->seconds);
      errors.push_back(run->error);
    }
    const std::vector<bool> front = report::pareto_front(seconds, errors);
    for (std::size_t i = 0; i < group.size(); ++i) group[i]->pareto = front[i];
  }
}

report::Table make_table(const Study& study, const std::vector<StudyRun>& runs, std::string (*number)(double)) {
  report::Table table;
  table.columns.push_back("run");
  for (const auto& [key, values] : study.grid) table.columns.push_back(key);
  const std::string figure = study.reference.figure();
  const bool turns = study.reference.measure == "hub_path";
  if (!figure.empty()) table.columns.push_back(figure);
  table.columns.emplace_back("error");
  if (turns) table.columns.emplace_back("turn_error_deg");
  for (const char* column : {"seconds", "ms_mean", "ms_p50", "ms_p95", "newton_per_step", "conditions_not_met", "pareto", "note"})
    table.columns.emplace_back(column);
  for (const StudyRun& run : runs) {
    std::vector<std::string> row = {std::to_string(table.rows.size() + 1)};
    row.insert(row.end(), run.values.begin(), run.values.end());
    if (!figure.empty()) row.push_back(run.measurable() ? number(run.measured.value) : "");
    const std::string note = run.finest ? "finest" : run.measurable() && std::isnan(run.error) ? "the finest run failed" : run.failure;
    row.push_back(std::isnan(run.error) ? "" : number(run.error));
    if (turns) row.push_back(std::isnan(run.error) ? "" : number(run.turn_error));
    for (const std::string& cell : {number(run.seconds), number(run.step_ms.mean), number(run.step_ms.p50), number(run.step_ms.p95),
                                    number(run.newton), std::to_string(run.unmet), std::string(run.pareto ? "*" : ""), note})
      row.push_back(cell);
    table.rows.push_back(row);
  }
  return table;
}

std::string label(const Study& study, const StudyRun& run) {
  std::string text;
  for (std::size_t k = 0; k < run.values.size(); ++k) {
    const std::string& key = study.grid[k].first;
    text += (k ? ", " : "") + key.substr(key.rfind('.') + 1) + " " + run.values[k];
  }
  return text;
}

/// One sentence: what accuracy costs here.
std::string conclusion(const Study& study, const std::vector<StudyRun>& runs) {
  const StudyRun *fastest = nullptr, *best = nullptr;
  for (const StudyRun& run : runs) {
    if (!run.pareto) continue;
    if (!fastest || run.seconds < fastest->seconds) fastest = &run;
    if (!best || run.error < best->error) best = &run;
  }
  if (!fastest) return "No run could be measured.";
  if (fastest == best)
    return fmt::format("The fastest run is also the most accurate: error {} in {} s ({}).", report::rounded(best->error),
                       report::rounded(best->seconds), label(study, *best));
  return fmt::format("An error of {} costs {} s ({}); {} times the time brings it down to {} ({}).", report::rounded(fastest->error),
                     report::rounded(fastest->seconds), label(study, *fastest), report::rounded(best->seconds / fastest->seconds),
                     report::rounded(best->error), label(study, *best));
}

/// For each value of a key the fastest run that comes near enough to the finest, and how much faster it is than the slowest of these.
std::string comparable(const Study& study, std::vector<StudyRun>& runs) {
  const Reference& reference = study.reference;
  std::string text;
  for (const std::vector<StudyRun*>& group : groups_of(study, runs)) {
    if (!group.back()->finest) continue;
    const Real finest = group.back()->measured.value;
    std::vector<const StudyRun*> chosen;
    for (const std::string& value : study.grid[reference.each].second) {
      const StudyRun* fastest = nullptr;
      for (const StudyRun* run : group) {
        if (run->values[reference.each] != value || !run->measurable()) continue;
        if (std::abs(run->measured.value - finest) > reference.within * std::abs(finest)) continue;
        if (!fastest || run->step_ms.mean < fastest->step_ms.mean) fastest = run;
      }
      if (fastest) chosen.push_back(fastest);
    }
    Real slowest = 0;
    for (const StudyRun* run : chosen) slowest = std::max(slowest, run->step_ms.mean);
    for (const StudyRun* run : chosen)
      text += fmt::format("  {}: {} = {}, {} ms a step, {} times as fast as the slowest\n", label(study, *run), reference.figure(),
                          report::rounded(run->measured.value), report::rounded(run->step_ms.mean),
                          report::rounded(slowest / run->step_ms.mean));
  }
  return fmt::format("fastest within {} % of the finest:\n{}", report::rounded(100 * reference.within), text);
}

/// @return what was written
std::string write_files(const Study& study, const std::vector<StudyRun>& runs, const std::filesystem::path& folder) {
  cosim::write_text(folder / "study.csv", report::to_csv(make_table(study, runs, tape::to_text)));
  report::Plot plot{"study " + study.name, "time [s]", error_label(study.reference), {}};
  for (std::size_t i = 0; i < runs.size(); ++i) {
    const StudyRun& run = runs[i];
    const std::string number = std::to_string(i + 1);
    if (run.error > 0)  // a logarithmic plot shows no other
      plot.points.push_back({run.seconds, run.error, run.pareto ? number + ": " + label(study, run) : number, run.pareto});
  }
  if (plot.points.empty()) return (folder / "study.csv").string();
  report::write_plot(plot, folder / "study");
  return (folder / "study.{csv,png,svg}").string();
}

int run_study(const std::string& file, const std::vector<std::string>& overrides, const std::string& out, int thread_count) {
  set_threads(thread_count);
  const Study study = load_study(file, overrides);
  const std::filesystem::path folder = out.empty() ? "out/" + study.name : out;
  const std::vector<std::vector<std::string>> combinations = study.combinations();
  for (const auto& values : combinations) load_combination(study, values);  // bad input is found before the first run
  cosim::make_folder(folder);
  remember_interrupts();
  const StudyStore store(folder / "runs.json");
  std::vector<StudyRun> runs;
  {
    Progress progress("study " + study.name, static_cast<int>(combinations.size()));
    for (const std::vector<std::string>& values : combinations) {
      StudyRun run = run_one(study, values, store);
      if (interrupted()) break;
      runs.push_back(std::move(run));
      progress.update(static_cast<int>(runs.size()), label(study, runs.back()));
    }
  }
  if (interrupted())
    fmt::print("interrupted after {} of {} runs; to go on, give the same command again\n", runs.size(), combinations.size());
  if (interrupted() && (runs.empty() || study.reference.kind == Reference::Kind::finest)) return kInterrupted;
  find_errors(study, runs);
  fmt::print("{}\n{}\n{}\n", error_label(study.reference), report::to_text(make_table(study, runs, report::rounded)),
             conclusion(study, runs));
  if (study.reference.within > 0) fmt::print("{}", comparable(study, runs));
  fmt::print("{}\n", write_files(study, runs, folder));
  if (interrupted()) return kInterrupted;
  for (const StudyRun& run : runs)
    if (!run.measurable()) return kFailed;
  return kDone;
}

struct StudyArguments {
  std::string file, out;
  std::vector<std::string> overrides;
  int threads = 0;
};
}  // namespace

void add_study(CLI::App& app, Action& chosen) {
  auto arguments = std::make_shared<StudyArguments>();
  CLI::App* command = app.add_subcommand("study", "runs one scene over a grid of settings: error against time");
  command->add_option("STUDY", arguments->file, "study file (YAML)")->required();
  command->add_option("--out", arguments->out, "folder for study.csv, study.png, study.svg (default: out/<study>)");
  command->add_option("--set", arguments->overrides, "set a key of the scene in every run; may be repeated")->allow_extra_args(false);
  command->add_option("--threads", arguments->threads, "threads of the CPU back end; 0: all cores")->check(CLI::Range(0, 1024));
  command->callback(
      [=, &chosen] { chosen = [=] { return run_study(arguments->file, arguments->overrides, arguments->out, arguments->threads); }; });
}
}  // namespace tape::tapesim
