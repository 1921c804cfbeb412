#pragma once
#include <string>
#include <vector>

#include "cosim/run/conditions.hpp"
#include "cosim/run/figures.hpp"

namespace cosim {
struct Distribution {
  Real mean = 0, p50 = 0, p95 = 0, max = 0;
};
/// p50 and p95 by the nearest rank.
Distribution distribution(std::vector<Real> values);

/// What the steps of a phase cost.
struct PhaseSummary {
  std::string name;         ///< empty: before the first phase
  Real start = 0, end = 0;  ///< [s] of its steps in this call
  int steps = 0;
  Real wall = 0;  ///< [s]
  Distribution step_ms;
  Real newton_mean = 0;
  std::vector<StageReport> effects, stages;  ///< mean over its steps
};

struct EffectSummary {
  PlanLine plan;
  Real ms_per_step = 0;
};

/// A run in numbers; what report.json says, without its names.
struct RunSummary {
  std::string status;   ///< done, failed or interrupted
  std::string failure;  ///< why and at which step, if failed
  int steps = 0;        ///< of this call
  Real sim_time = 0;    ///< [s] of this call
  Real wall = 0;        ///< [s]
  Distribution step_ms;
  Real newton_mean = 0;
  int newton_max = 0;
  int failed_steps = 0;  ///< Newton did not converge: retried at a fraction of dt, or the end
  int hessian_fallbacks = 0;
  std::string linear_solver;  ///< all that were used, joined by '+'
  Real linear_iterations_mean = 0;
  Real stop_error_estimate = 0;  ///< [m] largest of all steps
  Real min_gap = 0;              ///< [m]
  int intersections = 0;
  Real energy_drift = 0;  ///< [1] last balance / scale
  std::string state_hash;
  std::vector<EffectSummary> effects;
  std::vector<StageReport> stages;               ///< mean over the steps
  std::vector<std::pair<Real, CutReport>> cuts;  ///< [s] when, and what
  std::vector<Condition> conditions;
  bool fell_short = false;  ///< came to the end of the scene without meeting what that states
  FigureValues figures;
  std::vector<PhaseSummary> phases;  ///< that had steps in this call; none where the script names none
};
/// @param figures  names that the scene asks for
RunSummary summarize(const World& world, const RunLog& log, const std::vector<std::string>& figures);
}  // namespace cosim
