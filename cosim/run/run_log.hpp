#pragma once
#include <functional>
#include <string>
#include <vector>

#include "cosim/run/energy_ledger.hpp"
#include "cosim/scene/event.hpp"
#include "cosim/scene/goal.hpp"
#include "cosim/scene/phase.hpp"
#include "tape/step/cut.hpp"
#include "tape/step/stepper.hpp"

namespace cosim {
/// One step of a run.
struct StepRow {
  int step = 0;
  Real time = 0;  ///< [s] at its end
  StepReport report;
  EnergyLedger::Entry energy;
  std::vector<Real> goals = {};      ///< [goals] what their claims are about, at its end
  std::vector<CutReport> cuts = {};  ///< made or refused after the step
  int phase = -1;                    ///< of the script; -1: none has begun
  Real wall = 0;                     ///< [s] since the run began, when all about the step is done
};

/// Everything about a run that a report, its figures and its conditions are computed from.
struct RunLog {
  State start{}, end{};
  std::vector<StepRow> rows{};  ///< of the completed steps
  std::vector<Event> events{};  ///< that the script waits for; State::events says when they happened
  std::vector<Goal> goals{};    ///< conditions that the scene states
  std::vector<Phase> phases{};  ///< of the script
  bool interrupted = false;
  std::string failure{};   ///< why the run stopped before its time; empty if it did not
  int failed_step = -1;    ///< the step that could not be made
  int checked_states = 0;  ///< states that were searched for intersections
  int intersections = 0;   ///< found in them
  Real wall = 0;           ///< [s]
};

/// What a scene's `record:` section says.
struct RecordParams {
  Real rate = 30;
  template <class F>
  void fields(F&& f) {
    f("rate", rate, "1/s", Range::positive(), "recorded states per simulated second; a state is recorded at most once a step");
  }
};

struct RunOptions {
  int max_steps = -1;  ///< of this call; negative: until the duration of the scene
  RecordParams record{};
  std::vector<Event> events{};                                  ///< that the script waits for
  std::vector<Goal> goals{};                                    ///< conditions that the scene states
  std::vector<Phase> phases{};                                  ///< of the script
  std::function<bool()> stop_asked{};                           ///< asked before each step; may be empty
  std::function<void(const State&, const StepRow&)> on_step{};  ///< after each completed step; may be empty
  std::function<void()> on_cut{};                               ///< when a strip was cut: the world has changed; may be empty
  std::function<void(const State&)> on_record{};                ///< at the start, at the rate asked for, and at the end; may be empty
};

/// The phase of the step that a state is the end of; of the first one at the start.
int phase_of(const std::vector<Phase>& phases, const State& state, const World& world);

/// Steps that a scene asks for: duration / dt, rounded.
int planned_steps(const Scene& scene);

/// Runs a state to the end of the scene, or until something stops it. Cuts change the world.
RunLog simulate(World& world, Stepper& stepper, State& state, const RunOptions& options);
}  // namespace cosim
