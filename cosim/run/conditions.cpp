#include "cosim/run/conditions.hpp"

#include <algorithm>
#include <cstdio>
#include <limits>

namespace cosim {
namespace {
/// Six digits, for people.
std::string short_text(Real value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.6g", value);
  return text;
}
Condition at_most(const std::string& name, Real value, Real limit) { return {name, value, "<= " + short_text(limit), value <= limit}; }
Condition none(const std::string& name, Real value) { return {name, value, "== 0", value == 0}; }

template <class F>
Real largest(const RunLog& log, F&& value) {
  Real most = 0;
  for (const StepRow& row : log.rows) most = std::max(most, static_cast<Real>(value(row.report)));
  return most;
}
template <class F>
Real total(const RunLog& log, F&& value) {
  Real sum = 0;
  for (const StepRow& row : log.rows) sum += static_cast<Real>(value(row.report));
  return sum;
}

/// Work of a driven body is known to the first order in dt only; that of grips exactly.
Real energy_tolerance(const World& world) {
  for (const BodyPart& body : world.assembly.bodies)
    if (body.motion == Motion::driven) return 0.05;
  return 1e-6;
}
}  // namespace

Real energy_rise(const RunLog& log) {
  if (log.rows.empty() || log.rows.back().energy.scale <= 0) return 0;
  Real lowest = std::numeric_limits<Real>::infinity(), rise = 0;
  for (const StepRow& row : log.rows) {
    lowest = std::min(lowest, row.energy.balance);
    rise = std::max(rise, row.energy.balance - lowest);
  }
  return rise / log.rows.back().energy.scale;
}

std::vector<Condition> check_conditions(const World& world, const RunLog& log) {
  Real gap = std::numeric_limits<Real>::infinity();
  for (const StepRow& row : log.rows) gap = std::min(gap, row.report.min_gap);
  const Real stop_limit = world.setup.newton.velocity_tol * world.setup.scene.time.dt;
  return {
      none("failed_steps", log.failure.empty() ? 0 : 1),
      none("retried_steps", total(log, [](const StepReport& r) { return r.substeps > 1; })),
      none("linear_solves_at_their_limit", total(log, [](const StepReport& r) { return r.linear_failures; })),
      none("ccd_queries_at_their_limit", total(log, [](const StepReport& r) { return r.ccd_capped; })),
      at_most("stop_error_estimate_m", largest(log, [](const StepReport& r) { return r.stop_error_estimate; }), stop_limit),
      {"min_gap_m", gap, "> 0", gap > 0},
      none("intersections", log.intersections),
      at_most("max_strain", largest(log, [](const StepReport& r) { return r.max_strain; }), 0.05),
      at_most("energy_rise", energy_rise(log), energy_tolerance(world)),
  };
}
}  // namespace cosim
