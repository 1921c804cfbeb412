#include "cosim/run/summary.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <set>

namespace cosim {
namespace {
void summarize_steps(const RunLog& log, RunSummary& s) {
  std::vector<Real> ms;
  std::set<std::string> solvers;
  long newton = 0, linear = 0;
  s.failed_steps = log.failure.empty() ? 0 : 1;
  s.min_gap = std::numeric_limits<Real>::infinity();
  for (const StepRow& row : log.rows) {
    const StepReport& r = row.report;
    ms.push_back(r.wall_ms);
    newton += r.newton;
    linear += r.linear_iterations;
    s.newton_max = std::max(s.newton_max, r.newton);
    s.failed_steps += r.substeps > 1;
    s.hessian_fallbacks += r.hessian_fallbacks;
    s.stop_error_estimate = std::max(s.stop_error_estimate, r.stop_error_estimate);
    s.min_gap = std::min(s.min_gap, r.min_gap);
    if (!r.linear_solver.empty()) solvers.insert(r.linear_solver);
  }
  const auto n = static_cast<Real>(std::max<std::size_t>(1, log.rows.size()));
  s.step_ms = distribution(ms);
  s.newton_mean = static_cast<Real>(newton) / n;
  s.linear_iterations_mean = static_cast<Real>(linear) / static_cast<Real>(std::max(1L, newton));
  for (const std::string& name : solvers) s.linear_solver += (s.linear_solver.empty() ? "" : "+") + name;
}

void summarize_times(const World& world, const RunLog& log, RunSummary& s) {
  std::map<std::string, Real> effect_ms, stage_ms;
  const auto n = static_cast<Real>(std::max<std::size_t>(1, log.rows.size()));
  for (const StepRow& row : log.rows) {
    for (const EffectReport& e : row.report.effects) effect_ms[e.name] += e.ms / n;
    for (const StageReport& stage : row.report.stages) stage_ms[stage.name] += stage.ms / n;
  }
  for (const PlanLine& line : world.plan) s.effects.push_back({line, line.on ? effect_ms[line.name] : 0});
  for (const auto& [name, ms] : stage_ms) s.stages.push_back({name, ms});
}
}  // namespace

Distribution distribution(std::vector<Real> values) {
  if (values.empty()) return {};
  std::sort(values.begin(), values.end());
  const auto rank = [&](Real share) { return values[static_cast<std::size_t>(std::ceil(share * static_cast<Real>(values.size()))) - 1]; };
  return {std::accumulate(values.begin(), values.end(), Real{0}) / static_cast<Real>(values.size()), rank(0.5), rank(0.95), values.back()};
}

RunSummary summarize(const World& world, const RunLog& log, const std::vector<std::string>& figures) {
  RunSummary s;
  s.status = !log.failure.empty() ? "failed" : log.interrupted ? "interrupted" : "done";
  if (!log.failure.empty()) s.failure = "step " + std::to_string(log.failed_step) + ": " + log.failure;
  s.steps = static_cast<int>(log.rows.size());
  s.sim_time = log.end.time - log.start.time;
  s.wall = log.wall;
  summarize_steps(log, s);
  summarize_times(world, log, s);
  s.intersections = log.intersections;
  if (!log.rows.empty() && log.rows.back().energy.scale > 0) s.energy_drift = log.rows.back().energy.balance / log.rows.back().energy.scale;
  s.state_hash = log.end.hash();
  for (const StepRow& row : log.rows)
    for (const CutReport& cut : row.cuts) s.cuts.emplace_back(row.time, cut);
  s.conditions = check_conditions(world, log);
  const bool missed = std::ranges::any_of(s.conditions, [](const Condition& c) { return c.stated && !c.met; });
  s.fell_short = missed && log.end.step >= planned_steps(world.setup.scene);
  s.figures = measure_figures(figures, world, log);
  return s;
}
}  // namespace cosim
