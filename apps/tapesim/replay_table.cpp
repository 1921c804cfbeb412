#include "apps/tapesim/replay_table.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace tape::tapesim {
namespace {
constexpr const char* kNone = "";

std::string data_of(const ReplayResults& results, const std::string& episode) {
  return results.synthetic.contains(episode) ? "synthetic" : "recorded";
}
std::string data_of(const ReplayResults& results) {
  if (results.synthetic.empty()) return "recorded";
  return results.synthetic.size() < results.episodes.size() ? "both" : "synthetic";
}

ModelResult result_of(const ReplayResults& results, const std::string& model) {
  ModelResult result{.model = model, .score = {}, .reduction = {}};
  score::ModelErrors errors{model, {}};
  Real simulated = 0;
  bool whole = true;
  for (const std::string& episode : results.episodes) {
    errors.runs.emplace_back();
    for (const ReplayRun* run : results.repeats(model, episode)) {
      ++result.runs;
      result.failed += !run->failure.empty();
      if (run->failure.empty()) result.seconds += run->seconds, simulated += run->simulated;
      result.not_in_front += run->score.not_in_front;
      if (!run->frames.empty()) errors.runs.back().push_back(run->score.mean_error);
    }
    const std::vector<Real>& known = errors.runs.back();
    result.episodes.push_back(known.empty() ? std::nullopt : std::optional<Real>(score::mean(known)));
    whole = whole && !known.empty();
  }
  if (whole) result.score = score::model_score(errors);
  if (simulated > 0) result.per_simulated_second = result.seconds / simulated;
  if (result.runs > result.failed) result.seconds /= result.runs - result.failed;
  return result;
}
std::vector<score::FrameMean> frames_of(const ReplayResults& results, const std::string& model, const std::string& episode) {
  std::vector<std::vector<score::FrameError>> runs;
  for (const ReplayRun* run : results.repeats(model, episode)) runs.push_back(run->frames);
  return score::mean_errors(runs);
}
}  // namespace

std::vector<const ReplayRun*> ReplayResults::repeats(const std::string& model, const std::string& episode) const {
  std::vector<const ReplayRun*> found;
  for (const ReplayRun& run : runs)
    if (run.model == model && run.episode == episode) found.push_back(&run);
  return found;
}

std::vector<ModelResult> ReplayResults::by_model() const {
  std::vector<ModelResult> all;
  const ModelResult* base = nullptr;
  for (const std::string& model : models) all.push_back(result_of(*this, model));
  for (const ModelResult& result : all)
    if (result.model == baseline && result.score) base = &result;
  for (ModelResult& result : all)
    if (base && result.score && &result != base) result.reduction = score::reduction(*result.score, *base->score);
  return all;
}

report::Table model_table(const ReplayPlan& plan, const ReplayResults& results, std::string (*number)(double)) {
  report::Table table{{"model"}, {}};
  for (const std::string& episode : results.episodes) table.columns.push_back(episode + "_px");
  for (const char* column : {"mean_px", "mean_low_px", "mean_high_px", "reduction_percent", "reduction_low", "reduction_high"})
    table.columns.emplace_back(column);
  for (const auto& [whose, errors] : plan.beside) table.columns.push_back(whose + "_px");
  for (const char* column : {"s_per_run", "s_per_simulated_s", "runs", "failed", "not_in_front", "data"})
    table.columns.emplace_back(column);
  for (const ModelResult& r : results.by_model()) {
    std::vector<std::string> row{r.model};
    for (const std::optional<Real>& error : r.episodes) row.push_back(error ? number(*error) : kNone);
    for (Real value : r.score ? std::vector<Real>{r.score->mean, r.score->interval.low, r.score->interval.high} : std::vector<Real>{})
      row.push_back(number(value));
    if (!r.score) row.insert(row.end(), 3, kNone);
    if (r.reduction)
      for (Real share : {r.reduction->share, r.reduction->interval.low, r.reduction->interval.high}) row.push_back(number(100 * share));
    else
      row.insert(row.end(), 3, kNone);
    for (const auto& [whose, errors] : plan.beside) {
      const auto found = errors.find(r.model);
      row.push_back(found == errors.end() ? kNone : number(found->second));
    }
    for (const std::string& cell : {number(r.seconds), number(r.per_simulated_second), std::to_string(r.runs), std::to_string(r.failed),
                                    std::to_string(r.not_in_front), data_of(results)})
      row.push_back(cell);
    table.rows.push_back(row);
  }
  return table;
}

report::Table run_table(const ReplayResults& results) {
  report::Table table{
      {"episode", "model", "repeat", "mean_error_px", "frames", "estimated", "not_in_front", "worst_time_offset_s", "seconds",
       "simulated_s", "ms_mean", "ms_p50", "ms_p95", "newton_per_step", "conditions_not_met", "state_hash", "failure", "data"},
      {}};
  for (const ReplayRun& run : results.runs) {
    const bool scored = !run.frames.empty();
    const auto cell = [&](auto value) { return scored ? fmt::format("{}", value) : std::string(kNone); };
    const score::RunScore& s = run.score;
    table.rows.push_back({run.episode, run.model, std::to_string(run.repeat), scored ? to_text(s.mean_error) : kNone, cell(s.frames),
                          cell(s.estimated), cell(s.not_in_front), scored ? to_text(s.worst_time_offset) : kNone, to_text(run.seconds),
                          to_text(run.simulated), to_text(run.step_ms.mean), to_text(run.step_ms.p50), to_text(run.step_ms.p95),
                          to_text(run.newton), std::to_string(run.unmet), run.state_hash, run.failure, data_of(results, run.episode)});
  }
  return table;
}

report::Table frame_table(const ReplayResults& results) {
  report::Table table{{"episode", "model", "time_s", "error_px", "estimated", "data"}, {}};
  for (const std::string& episode : results.episodes)
    for (const std::string& model : results.models)
      for (const score::FrameMean& frame : frames_of(results, model, episode))
        table.rows.push_back(
            {episode, model, to_text(frame.time), to_text(frame.error), frame.estimated ? "1" : "0", data_of(results, episode)});
  return table;
}

std::vector<std::variant<report::Curves, report::Plot>> replay_page(const ReplayResults& results) {
  std::vector<std::variant<report::Curves, report::Plot>> page;
  for (const std::string& episode : results.episodes) {
    report::Curves curves{fmt::format("{} ({})", episode, data_of(results, episode)), "time [s]", "error [px]", {}};
    bool any = false;
    for (const std::string& model : results.models) {
      report::Curve curve{model, {}};
      for (const score::FrameMean& frame : frames_of(results, model, episode))
        curve.points.push_back({frame.time, frame.error, frame.estimated});
      any = any || !curve.points.empty();
      curves.curves.push_back(std::move(curve));
    }
    if (any) page.emplace_back(std::move(curves));
  }
  if (page.empty()) return page;
  report::Plot price{fmt::format("accuracy and its price ({})", data_of(results)), "time [s] per simulated second", "mean error [px]", {}};
  std::vector<Real> cost, error;
  for (const ModelResult& result : results.by_model()) {
    if (!result.score) continue;
    price.points.push_back({result.per_simulated_second, result.score->mean, result.model});
    cost.push_back(result.per_simulated_second), error.push_back(result.score->mean);
  }
  const std::vector<bool> front = report::pareto_front(cost, error);
  for (std::size_t i = 0; i < front.size(); ++i) price.points[i].pareto = front[i];
  for (const ReplayRun& run : results.runs)
    if (!run.frames.empty()) price.points.push_back({run.seconds / run.simulated, run.score.mean_error, ""});
  if (std::ranges::any_of(price.points, [](const report::PlotPoint& p) { return p.x > 0 && p.y > 0; })) page.emplace_back(std::move(price));
  return page;
}
}  // namespace tape::tapesim
