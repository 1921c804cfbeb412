#include "cosim/run/run_log.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>

#include "cosim/run/event_watch.hpp"
#include "cosim/run/measure.hpp"
#include "cosim/run/record_clock.hpp"
#include "tape/contact/intersection.hpp"
#include "tape/core/stopwatch.hpp"
#include "tape/step/reduce.hpp"

namespace cosim {
namespace {
void record(RunLog& log, const World& world, const State& state, const RunOptions& options) {
  log.checked_states += 1;
  log.intersections += find_intersections(world.surface, carry(world, state).owner, vertex_positions(world, state)).count;
  if (options.on_record) options.on_record(state);
}
/// Cuts what blades have pressed long enough. @return whether the world has changed
bool cut(World& world, Stepper& stepper, State& state, EnergyLedger& ledger, StepRow& row) {
  Real ms = 0;
  {
    const Stopwatch watch(ms);
    row.cuts = cut_strips(world, state, row.report.blades);
  }
  row.report.wall_ms += ms;
  for (StageReport& stage : row.report.stages)
    if (stage.name == "cutting") stage.ms += ms;
  const bool made = std::ranges::any_of(row.cuts, [](const CutReport& c) { return c.refusal.empty(); });
  if (!made) return false;
  Real stored = 0;
  for (const EffectReport& effect : row.report.effects) stored += effect.energy;
  Real change = stepper.renew(state) - stored;
  for (const CutReport& c : row.cuts) change += c.kinetic;
  ledger.add_work(change);
  return true;
}
}  // namespace

int phase_of(const std::vector<Phase>& phases, const State& state, const World& world) {
  const Real dt = world.setup.scene.time.dt;
  return phase_at(phases, std::max(Real{0}, state.time - dt), state.events, dt);
}

int planned_steps(const Scene& scene) { return static_cast<int>(std::lround(scene.time.duration / scene.time.dt)); }

RunLog simulate(World& world, Stepper& stepper, State& state, const RunOptions& options) {
  const auto wall = [begin = std::chrono::steady_clock::now()] {
    return std::chrono::duration<Real>(std::chrono::steady_clock::now() - begin).count();
  };
  const int planned = planned_steps(world.setup.scene);
  const int last = options.max_steps < 0 || options.max_steps > planned - state.step ? planned : state.step + options.max_steps;
  RunLog log{.start = state, .events = options.events, .goals = options.goals, .phases = options.phases};
  const auto* coupled = dynamic_cast<const CoupledStepper*>(&stepper);  // none where there are no robots
  EnergyLedger ledger(world);
  RecordClock clock(options.record.rate, state.time);
  record(log, world, state, options);
  int recorded = state.step;
  while (state.step < last && log.failure.empty()) {
    if (options.stop_asked && options.stop_asked()) {
      log.interrupted = true;
      break;
    }
    ledger.before(state, world.setup.scene.time.dt);
    StepReport report = stepper.step(state);
    if (!report.ok) {
      log.failure = report.failure;
      log.failed_step = state.step + 1;
      break;
    }
    const JointPositions joints = coupled ? coupled->joints() : JointPositions{};
    note_events(options.events, world, report, joints, state);
    const EnergyLedger::Entry energy = ledger.after(state, report);
    log.rows.push_back({.step = state.step,
                        .time = state.time,
                        .report = std::move(report),
                        .energy = energy,
                        .phase = phase_of(options.phases, state, world)});
    StepRow& row = log.rows.back();
    if (cut(world, stepper, state, ledger, row) && options.on_cut) options.on_cut();
    for (const Goal& goal : options.goals) row.goals.push_back(measure(goal.claim, world, state, row.report, joints));
    if (options.on_step) options.on_step(state, row);
    if (clock.due(state.time)) {
      record(log, world, state, options);
      recorded = state.step;
    }
    row.wall = wall();
  }
  if (recorded != state.step) record(log, world, state, options);
  log.end = state;
  log.wall = wall();
  return log;
}
}  // namespace cosim
