#include "apps/report/steps_csv.hpp"

#include <algorithm>
#include <limits>

namespace tape::report {
namespace {
std::string cell(Real value) { return tape::to_text(value); }
std::string cell(const std::string& text) { return text; }

/// Visits (name, number or text) of every column; `row` may be empty when only names are wanted.
template <class F>
void visit_columns(const World& world, const std::vector<Phase>& phases, const cosim::StepRow& row, const F& f) {
  const StepReport& r = row.report;
  f("step", row.step), f("time_s", row.time);
  if (!phases.empty()) f("phase", row.phase < 0 ? std::string() : phases[static_cast<std::size_t>(row.phase)].name);
  f("ms", r.wall_ms);
  f("newton", r.newton), f("linear_iterations", r.linear_iterations), f("halvings", r.halvings), f("shortened", r.shortened),
      f("substeps", r.substeps);
  f("hessian_fallbacks", r.hessian_fallbacks), f("stop_error_estimate_m", r.stop_error_estimate), f("last_update_m", r.last_update);
  f("min_gap_m", r.min_gap), f("candidates", r.candidates), f("active_pairs", r.active_pairs), f("searches", r.searches);
  f("max_strain", r.max_strain), f("kinetic_J", r.kinetic);
  for (const PlanLine& line : world.plan) {
    if (!line.on) continue;
    const auto found = std::find_if(r.effects.begin(), r.effects.end(), [&](const EffectReport& e) { return e.name == line.name; });
    f(line.name + "_J", found == r.effects.end() ? 0 : found->energy);
    f(line.name + "_ms", found == r.effects.end() ? 0 : found->ms);
  }
  f("work_J", row.energy.work), f("energy_balance_J", row.energy.balance);
  for (std::size_t k = 0; k < world.setup.scene.adhesives.size(); ++k) {
    const AdhesivePair& pair = world.setup.scene.adhesives[k];
    const auto name = [&](int m) { return world.setup.scene.materials[static_cast<std::size_t>(m)].name; };
    const std::string between = "adhesion_" + name(pair.a) + "_" + name(pair.b) + "_";
    const AdhesionReport a = k < r.adhesion.size() ? r.adhesion[k] : AdhesionReport{};
    f(between + "normal_N", a.normal), f(between + "tangential_N", a.tangential), f(between + "live", a.live);
    f(between + "from_m", a.from), f(between + "to_m", a.to);
  }
  if (!world.setup.scene.adhesives.empty()) f("adhesion_work_J", r.adhesion_work);
  if (world.clusters() > 0 || world.setup.scene.sleep.after > 0) f("woken_J", r.woken);
  if (world.setup.scene.sleep.after > 0) f("asleep", r.asleep);
  const auto vector = [&](const std::string& name, const std::string& unit, const Vec3& v) {
    for (int c = 0; c < 3; ++c) f(name + "_" + "xyz"[c] + "_" + unit, v[c]);
  };
  const auto at = [](const std::vector<Vec3>& values, std::size_t i) { return i < values.size() ? values[i] : Vec3(Vec3::Zero()); };
  vector("momentum", "kg_m_per_s", r.momentum);
  for (std::size_t g = 0; g < world.setup.scene.grips.size(); ++g)
    vector("grip_" + world.setup.scene.grips[g].name, "N", at(r.grip_force, g));
  for (std::size_t k = 0; k < world.setup.scene.axles.size(); ++k)
    f("axle_" + world.setup.scene.axles[k].body + "_Nm", k < r.axle_torque.size() ? r.axle_torque[k] : 0);
  for (std::size_t b = 0; b < world.setup.scene.bodies.size(); ++b)
    if (const Motion m = world.assembly.bodies[b].motion; m == Motion::driven || m == Motion::dynamic)
      vector("body_" + world.setup.scene.bodies[b].name, "N", at(r.body_force, b));
  for (std::size_t a = 0; a < world.setup.scene.articulations.size(); ++a) {
    const std::vector<std::string>& links = world.setup.scene.articulations[a].links;
    for (std::size_t l = 0; l < links.size(); ++l) {
      const LinkReport link = a < r.articulations.size() ? r.articulations[a].links[l] : LinkReport{};
      for (const auto& [what, wrench] :
           {std::pair{"_normal", link.normal}, {"_friction", link.friction}, {"_adhesion", link.adhesion}, {"_hold", link.hold}})
        vector("link_" + links[l] + what, "N", wrench.force), vector("link_" + links[l] + what, "Nm", wrench.torque);
    }
  }
  if (!world.setup.scene.blades.empty()) {
    Real pressure = 0;
    for (const BladePressure& p : r.blades) pressure = std::max(pressure, p.peak);
    const auto made = std::ranges::count_if(row.cuts, [](const CutReport& c) { return c.refusal.empty(); });
    f("blade_pressure_Pa", pressure), f("cuts", static_cast<Real>(made)), f("cuts_refused", static_cast<Real>(std::ssize(row.cuts) - made));
  }
  if (!world.setup.scene.articulations.empty())
    f("momentum_exchange_residual", r.exchange_residual.value_or(std::numeric_limits<Real>::quiet_NaN())),
        f("unsettled_substeps", r.unsettled_substeps), f("link_mismatch_m", r.link_mismatch);
}
}  // namespace

std::vector<std::string> step_columns(const World& world, const std::vector<Phase>& phases) {
  std::vector<std::string> names;
  visit_columns(world, phases, {}, [&](const std::string& name, const auto&) { names.push_back(name); });
  return names;
}

std::vector<std::string> step_cells(const World& world, const std::vector<Phase>& phases, const cosim::StepRow& row) {
  std::vector<std::string> cells;
  visit_columns(world, phases, row, [&](const std::string&, const auto& value) { cells.push_back(cell(value)); });
  return cells;
}
}  // namespace tape::report
