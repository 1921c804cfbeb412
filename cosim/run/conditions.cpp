#include "cosim/run/conditions.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <numbers>

#include "cosim/run/measure.hpp"
#include "tape/effects/barrier_law.hpp"
#include "tape/model/strip_mesh.hpp"

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

/// Work of driven bodies and of links is known to the first order in dt only; that of grips exactly.
Real energy_tolerance(const World& world) {
  for (const BodyPart& body : world.assembly.bodies)
    if (body.motion == Motion::driven || body.motion == Motion::linked) return 0.05;
  return 1e-6;
}
/// [m] of what is of this material.
Real half_thickness(const Scene& scene, int material) {
  for (const Strip& strip : scene.strips)
    if (strip.material == material) return scene.films[static_cast<std::size_t>(strip.film)].xi;
  const auto body = std::ranges::find(scene.bodies, material, &Body::material);
  return body == scene.bodies.end() ? 0 : body->xi;
}
/// What tape that sticks by area needs, the worst of all: the mesh must resolve the fold, of radius sqrt(D/2R), and the zone behind the
/// front that carries load, pi/2 times the length (4 D/k)^(1/4) of a beam on a foundation of the mean stiffness k = strength/final; and the
/// barrier, which pushes where the tape rests, must have less to give than adhesion.
void add_peel_conditions(const World& world, std::vector<Condition>& conditions) {
  const Scene& scene = world.setup.scene;
  const int samples = params<CohesiveZone>(world.setup.effects).samples;
  Real cell_per_fold = 0, push = 0, given = 0, samples_in_zone = std::numeric_limits<Real>::infinity();
  for (const AdhesivePair& pair : scene.adhesives) {
    if (pair.adhesion.law != AdhesionLaw::per_area) continue;
    const AreaCohesion& law = pair.adhesion.area;
    for (const Strip& strip : scene.strips) {
      if (strip.material != pair.a && strip.material != pair.b) continue;
      const Film& film = scene.films[static_cast<std::size_t>(strip.film)];
      const Real stiffness = film.plate_stiffness(), cell = cell_length(strip.mesh, film.width);
      const Real zone = std::numbers::pi / 2 * std::pow(4 * stiffness * law.final_opening() / law.strength, 0.25);
      const Real xi = film.xi + half_thickness(scene, strip.material == pair.a ? pair.b : pair.a);
      const Jet barrier = BarrierLaw{scene.kappa(pair.a, pair.b), scene.dhat()}.at(xi + law.rest * scene.dhat(), xi, 1);
      push = std::max(push, -barrier.slope / law.strength);
      given = std::max(given, barrier.value / law.toughness);
      cell_per_fold = std::max(cell_per_fold, cell / std::sqrt(stiffness / (2 * law.toughness)));
      samples_in_zone = std::min(samples_in_zone, samples * zone / cell);
    }
  }
  if (cell_per_fold == 0) return;
  conditions.push_back(at_most("cell_per_fold_radius", cell_per_fold, 0.3));
  conditions.push_back(at_most("barrier_pressure_per_strength", push, 0.25));
  conditions.push_back(at_most("barrier_energy_per_toughness", given, 0.01));
  conditions.push_back({"samples_in_peel_zone", samples_in_zone, ">= 3", samples_in_zone >= 3});
}
/// What the script has waited for, and whether it came or its time was over.
void add_waits(const World& world, const RunLog& log, std::vector<Condition>& conditions) {
  for (std::size_t k = 0; k < log.events.size(); ++k) {
    const Event& event = log.events[k];
    const Real took = log.end.events[k] - event.start.at(log.end.events);
    if (std::isfinite(took))
      conditions.push_back(
          {to_text(event), took, "< " + tape::to_text(event.timeout) + " s", took < event.timeout - world.setup.scene.time.dt / 2});
  }
}
/// What the scene states: the worst value of the time in which it must be true, that of the last step at least.
void add_goals(const RunLog& log, std::vector<Condition>& conditions) {
  for (std::size_t k = 0; k < log.goals.size(); ++k) {
    const Goal& goal = log.goals[k];
    Real worst = std::numeric_limits<Real>::quiet_NaN();
    for (const StepRow& row : log.rows) {
      const bool last = &row == &log.rows.back();
      if (!last && row.time < log.rows.back().time - goal.held - 1e-6 * row.report.dt) continue;
      const Real value = row.goals[k];
      if (std::isnan(worst) || (goal.claim.above ? value < worst : value > worst)) worst = value;
    }
    std::string required = (goal.claim.above ? "> " : "< ") + short_text(goal.claim.level);
    if (goal.held > 0) required += " for the last " + short_text(goal.held) + " s";
    conditions.push_back({goal.name, worst, required, holds(goal.claim, worst), true});
  }
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
  std::vector<Condition> conditions{
      none("failed_steps", log.failure.empty() ? 0 : 1),
      none("retried_steps", total(log, [](const StepReport& r) { return r.substeps > 1; })),
      none("linear_solves_at_their_limit", total(log, [](const StepReport& r) { return r.linear_failures; })),
      none("ccd_queries_at_their_limit", total(log, [](const StepReport& r) { return r.ccd_capped; })),
      none("unsettled_substeps", total(log, [](const StepReport& r) { return r.unsettled_substeps; })),
      at_most("link_mismatch_m", largest(log, [](const StepReport& r) { return r.link_mismatch; }), world.setup.scene.dhat()),
      at_most("stop_error_estimate_m", largest(log, [](const StepReport& r) { return r.stop_error_estimate; }), stop_limit),
      {"min_gap_m", gap, "> 0", gap > 0},
      none("intersections", log.intersections),
      at_most("max_strain", largest(log, [](const StepReport& r) { return r.max_strain; }), 0.05),
      at_most("energy_rise", energy_rise(log), energy_tolerance(world)),
  };
  add_peel_conditions(world, conditions);
  add_waits(world, log, conditions);
  add_goals(log, conditions);
  return conditions;
}
}  // namespace cosim
