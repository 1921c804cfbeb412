#include "cosim/run/summary.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <set>
#include <span>

namespace cosim {
namespace {
using Rows = std::span<const StepRow>;

Real count(Rows rows) { return static_cast<Real>(std::max<std::size_t>(1, rows.size())); }
Distribution step_ms(Rows rows) {
  std::vector<Real> ms;
  for (const StepRow& row : rows) ms.push_back(row.report.wall_ms);
  return distribution(std::move(ms));
}
Real newton_mean(Rows rows) {
  Real sum = 0;
  for (const StepRow& row : rows) sum += row.report.newton;
  return sum / count(rows);
}
/// Mean times of a step, of what the member lists.
template <class Part>
std::map<std::string, Real> mean_ms(Rows rows, std::vector<Part> StepReport::*parts) {
  std::map<std::string, Real> ms;
  for (const StepRow& row : rows)
    for (const Part& part : row.report.*parts) ms[part.name] += part.ms / count(rows);
  return ms;
}
std::vector<StageReport> as_list(const std::map<std::string, Real>& ms) {
  std::vector<StageReport> list;
  for (const auto& [name, value] : ms) list.push_back({name, value});
  return list;
}

void summarize_steps(const RunLog& log, RunSummary& s) {
  std::set<std::string> solvers;
  long newton = 0, linear = 0;
  s.failed_steps = log.failure.empty() ? 0 : 1;
  s.min_gap = std::numeric_limits<Real>::infinity();
  for (const StepRow& row : log.rows) {
    const StepReport& r = row.report;
    newton += r.newton;
    linear += r.linear_iterations;
    s.newton_max = std::max(s.newton_max, r.newton);
    s.failed_steps += r.substeps > 1;
    s.hessian_fallbacks += r.hessian_fallbacks;
    s.stop_error_estimate = std::max(s.stop_error_estimate, r.stop_error_estimate);
    s.min_gap = std::min(s.min_gap, r.min_gap);
    if (!r.linear_solver.empty()) solvers.insert(r.linear_solver);
  }
  s.step_ms = step_ms(log.rows);
  s.newton_mean = newton_mean(log.rows);
  s.linear_iterations_mean = static_cast<Real>(linear) / static_cast<Real>(std::max(1L, newton));
  for (const std::string& name : solvers) s.linear_solver += (s.linear_solver.empty() ? "" : "+") + name;
}

void summarize_times(const World& world, const RunLog& log, RunSummary& s) {
  std::map<std::string, Real> effect_ms = mean_ms(log.rows, &StepReport::effects);
  for (const PlanLine& line : world.plan) s.effects.push_back({line, line.on ? effect_ms[line.name] : 0});
  s.stages = as_list(mean_ms(log.rows, &StepReport::stages));
}

std::vector<PhaseSummary> summarize_phases(const RunLog& log) {
  std::vector<PhaseSummary> phases;
  if (log.phases.empty()) return phases;
  Real time = log.start.time, wall = 0;  // [s] at its start
  for (auto first = log.rows.begin(); first != log.rows.end();) {
    const auto end = std::find_if(first, log.rows.end(), [&](const StepRow& row) { return row.phase != first->phase; });
    const Rows rows(first, end);
    phases.push_back({.name = first->phase < 0 ? "" : log.phases[static_cast<std::size_t>(first->phase)].name,
                      .start = time,
                      .end = rows.back().time,
                      .steps = static_cast<int>(rows.size()),
                      .wall = rows.back().wall - wall,
                      .step_ms = step_ms(rows),
                      .newton_mean = newton_mean(rows),
                      .effects = as_list(mean_ms(rows, &StepReport::effects)),
                      .stages = as_list(mean_ms(rows, &StepReport::stages))});
    time = rows.back().time, wall = rows.back().wall;
    first = end;
  }
  return phases;
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
  s.phases = summarize_phases(log);
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
