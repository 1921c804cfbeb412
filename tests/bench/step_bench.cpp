#include <benchmark/benchmark.h>

#include <ctime>
#include <map>

#include "tape/core/execution.hpp"
#include "tape/model/primitives.hpp"
#include "tests/support/simulation.hpp"

/// Cost of whole steps for strips of `rows` rows of 7 vertices, curled to and fro, that fall freely or land on a table. One thread;
/// `us` is microseconds of CPU per row and Newton iteration, and so are its parts: the stages, what assembly and line search spend in
/// the effects, and the rest of the step (drives, report).
using namespace tape;

namespace {
Setup strip(int rows, bool table) {
  constexpr int kCells = 6, kRowsPerArc = 20;
  constexpr Real kTurn = 0.2;                      // [rad] of each arc
  const Real cell = test::vinyl().width / kCells;  // [m]
  Strip s = test::flat_strip(cell * (rows - 1), kCells, Vec3::Zero());
  for (int r = 0; r < rows; r += kRowsPerArc) s.path.push_back({cell * kRowsPerArc, (r / kRowsPerArc + 1) / 2 % 2 == 0 ? kTurn : -kTurn});
  Setup setup = test::strip_setup(s);
  setup.scene.gravity = Vec3(0, 0, -9.81);
  if (table) {
    const Real length = cell * rows;
    const TriangleMesh mesh = box_mesh(Vec3(1.1 * length, 0.1, 0.02), {1 + rows / 100, 1, 1});
    test::add_body(setup, "table", mesh, Motion::fixed, Vec3(length / 2, 0, -0.0105));  // its top is 0.5 mm below the strip
  }
  return setup;
}

/// [ms] of this thread alone: the threads that set_threads(1) leaves without work may spin beside it.
Real thread_cpu_ms() {
  timespec t;
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return 1e3 * static_cast<Real>(t.tv_sec) + 1e-6 * static_cast<Real>(t.tv_nsec);
}

/// Mean over steps 2 to 4; on the table the troughs touch down.
void steps(benchmark::State& state, bool table) {
  const int rows = static_cast<int>(state.range(0));
  set_threads(1);
  test::Simulation simulation(strip(rows, table));
  simulation.check_intersections = false;
  simulation.step();  // the first step of a process also pays for memory and threads
  std::map<std::string, Real> ms;
  Real iterations = 0, linear = 0, pairs = 0;
  const Real start = thread_cpu_ms();
  for (auto _ : state) {
    const StepReport& r = simulation.step();
    if (!r.ok) state.SkipWithError(r.failure.c_str());
    iterations += r.newton;
    linear += r.linear_iterations;
    pairs += r.active_pairs;
    ms["wall"] += r.wall_ms;
    for (const StageReport& stage : r.stages) ms[stage.name] += stage.ms;
    for (const EffectReport& effect : r.effects) ms[effect.name] += effect.ms;
  }
  const Real cpu = thread_cpu_ms() - start;
  const Real share = cpu / ms["wall"], steps = static_cast<Real>(state.iterations());
  for (const auto& [name, t] : ms)
    if (name != "wall") state.counters[name] = 1e3 * share * t / (rows * iterations);
  state.counters["us"] = 1e3 * cpu / (rows * iterations);
  state.counters["newton"] = iterations / steps;
  state.counters["cg"] = linear / iterations;
  state.counters["pairs_per_row"] = pairs / (rows * steps);
  state.SetLabel(simulation.report().linear_solver);
}
}  // namespace

#define TAPE_ROWS ->Arg(100)->Arg(1000)->Arg(10000)->Iterations(3)->Unit(benchmark::kMillisecond)
BENCHMARK_CAPTURE(steps, free, false) TAPE_ROWS;
BENCHMARK_CAPTURE(steps, on_table, true) TAPE_ROWS;
