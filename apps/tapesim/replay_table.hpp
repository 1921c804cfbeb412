#pragma once
#include <optional>
#include <set>

#include "apps/report/plot.hpp"
#include "apps/report/table.hpp"
#include "apps/tapesim/replay_plan.hpp"
#include "apps/tapesim/replay_run.hpp"

namespace tape::tapesim {
/// What replays of one model have come to.
struct ModelResult {
  std::string model;
  std::vector<std::optional<Real>> episodes = {};  ///< [px] mean over the runs that were scored
  std::optional<score::ModelScore> score;          ///< none unless every episode has a run that was scored
  std::optional<score::Reduction> reduction;       ///< against the baseline, where both are scored
  Real seconds = 0, per_simulated_second = 0;      ///< of the clock: a run that did not fail, mean; and for each second of the simulation
  int runs = 0, failed = 0;
  int not_in_front = 0;  ///< frames without an error
};

/// Everything that was run, in the order of models, episodes and repeats.
struct ReplayResults {
  std::vector<std::string> episodes, models;  ///< by their names
  std::string baseline;
  std::set<std::string> synthetic;  ///< episodes that are
  Real lead_in = 0;                 ///< [s] longest of the episodes
  std::vector<ReplayRun> runs;

  std::vector<const ReplayRun*> repeats(const std::string& model, const std::string& episode) const;
  std::vector<ModelResult> by_model() const;
};

/// A row for each model: errors [px] by episode and mean, interval, reduction, what others report, time.
report::Table model_table(const ReplayPlan& plan, const ReplayResults& results, std::string (*number)(double));
/// A row for each run.
report::Table run_table(const ReplayResults& results);
/// A row for each frame of an episode and model: error [px], mean over the repeats.
report::Table frame_table(const ReplayResults& results);
/// Of each episode the error over time of each model, mean over the repeats, rings where the real landmark is estimated; and the mean
/// errors of models and runs against their time. Without what cannot be shown.
std::vector<std::variant<report::Curves, report::Plot>> replay_page(const ReplayResults& results);
}  // namespace tape::tapesim
