#include <benchmark/benchmark.h>

#include "tape/core/execution.hpp"
#include "tape/solver/cholesky.hpp"
#include "tape/solver/cost_model.hpp"
#include "tape/solver/linear_solver.hpp"
#include "tape/solver/two_level.hpp"
#include "tests/support/loaded_system.hpp"

/// Cost of the linear part for strips of `rows` rows of 7 vertices: the constants of the cost model (tape/solver/README.md) come
/// from here. One thread; "per_row" is CPU seconds per row, "flops" what the cost model counts.
using namespace tape;
using namespace tape::on_cpu;
using test::StripSystem;

namespace {
struct Loaded : test::LoadedSystem {
  HostBlocks host;
  explicit Loaded(StripSystem s) : LoadedSystem(std::move(s)) { matrix.download(host); }
};
/// What `range(0)` counts: rows of a strip, or turns of a roll.
enum class Shape { strip, fold, light_strip, light_fold, light_roll };
/// Light ones have the ratios of mass / dt^2, contact and film of real tape at dt = 10 ms; the others are held by their mass.
StripSystem make(Shape shape, int size) {
  StripSystem s;
  if (shape >= Shape::light_strip) s.vertex_mass = 2e-4;
  if (shape == Shape::light_roll) {
    s.add_roll(size, 10);
    return s;
  }
  s.add_strip(size);
  if (shape == Shape::fold) s.fold(0, size, 1e4);
  if (shape == Shape::light_fold) s.fold(0, size, 10);
  return s;
}
Loaded loaded(const benchmark::State& state, Shape shape = Shape::strip) {
  set_threads(1);
  return Loaded(make(shape, static_cast<int>(state.range(0))));
}

void report(benchmark::State& state, const Loaded& a, Real items_per_iteration, Real flops = 0) {
  using benchmark::Counter;
  const auto iterations = static_cast<Real>(state.iterations());
  state.counters["blocks_per_s"] = Counter(items_per_iteration * iterations, Counter::kIsRate);
  state.counters["per_row"] =
      Counter(static_cast<Real>(a.system.n) / StripSystem::kColumns * iterations, Counter::kIsRate | Counter::kInvert);
  if (flops > 0) state.counters["flops"] = Counter(flops * iterations, Counter::kIsRate);
}

void pattern(benchmark::State& state) {
  const Loaded a = loaded(state);
  for (auto _ : state) {
    BlockMatrix fresh;
    fresh.set_fixed_pattern(a.system.n, a.fixed_keys.span());
  }
  report(state, a, a.fixed_keys.size());
}
void accumulate(benchmark::State& state) {
  Loaded a = loaded(state);
  for (auto _ : state) a.matrix.accumulate_fixed(a.fixed_values.span());
  report(state, a, a.fixed_keys.size());
}
void multiply(benchmark::State& state) {
  Loaded a = loaded(state);
  for (auto _ : state) a.matrix.multiply(a.b.span(), a.x.span());
  report(state, a, a.matrix.blocks(), 36.0 * a.matrix.blocks());
}
void strip_factor(benchmark::State& state) {
  const Loaded a = loaded(state);
  StripFactor factor(a.system.layout);
  for (auto _ : state) factor.factor(a.host);
  const Real kd = 3 * (2 * StripSystem::kColumns) + 2;
  report(state, a, a.matrix.blocks(), 3.0 * a.system.n * kd * kd);
}
void strip_solve(benchmark::State& state) {
  Loaded a = loaded(state);
  StripFactor factor(a.system.layout);
  factor.factor(a.host);
  for (auto _ : state) factor.solve(a.b.span(), a.x.span());
  const Real kd = 3 * (2 * StripSystem::kColumns) + 2;
  report(state, a, a.matrix.blocks(), 4 * 3.0 * a.system.n * kd);
}
void cholesky_analysis(benchmark::State& state) {
  const Loaded a = loaded(state);
  for (auto _ : state) Cholesky().analyze(a.host);
  report(state, a, a.matrix.blocks());
}
void cholesky_factor(benchmark::State& state) {
  const Loaded a = loaded(state);
  Cholesky cholesky;
  for (auto _ : state) cholesky.factor(a.host);
  report(state, a, a.matrix.blocks(), cholesky.factor_flops());
}
void cholesky_solve(benchmark::State& state) {
  Loaded a = loaded(state);
  Cholesky cholesky;
  cholesky.factor(a.host);
  for (auto _ : state) cholesky.solve(a.b.span(), a.x.span());
  report(state, a, a.matrix.blocks(), 4 * cholesky.factor_nonzeros());
}
void two_level_build(benchmark::State& state) {
  Loaded a = loaded(state);
  TwoLevel m(a.system.layout);
  for (auto _ : state) m.build(a.matrix, a.points.span());
  report(state, a, a.matrix.blocks());
}
void cost_model(benchmark::State& state) {
  const Loaded a = loaded(state, Shape::fold);
  for (auto _ : state) benchmark::DoNotOptimize(linear_costs(a.host, a.system.layout));
  report(state, a, a.matrix.blocks());
}

/// The whole solve, pattern kept; the label is the solver that ran, its iterations, and what the cost model foresaw.
void solve(benchmark::State& state, LinearKind kind, Shape shape) {
  Loaded a = loaded(state, shape);
  LinearSolver solver({.linear = kind}, a.system.layout);
  LinearReport last;
  for (auto _ : state) last = solver.solve(a.matrix, a.points.span(), a.b.span(), a.x.span());
  const LinearCosts costs = linear_costs(a.host, a.system.layout);
  report(state, a, a.matrix.blocks());
  state.counters["iterations"] = last.iterations;
  state.counters["model_ms"] = 1e3 * (last.solver == "pcg_strip"       ? costs.pcg_strip
                                      : last.solver == "pcg_jacobi"    ? costs.pcg_jacobi
                                      : last.solver == "pcg_two_level" ? costs.pcg_two_level
                                                                       : costs.cholesky);
  state.SetLabel(last.solver);
}
}  // namespace

#define TAPE_ROWS ->Arg(100)->Arg(1000)->Arg(10000)->Unit(benchmark::kMillisecond)
BENCHMARK(pattern) TAPE_ROWS;
BENCHMARK(accumulate) TAPE_ROWS;
BENCHMARK(multiply) TAPE_ROWS;
BENCHMARK(strip_factor) TAPE_ROWS;
BENCHMARK(strip_solve) TAPE_ROWS;
BENCHMARK(cholesky_analysis) TAPE_ROWS;
BENCHMARK(cholesky_factor) TAPE_ROWS;
BENCHMARK(cholesky_solve) TAPE_ROWS;
BENCHMARK(two_level_build) TAPE_ROWS;
BENCHMARK(cost_model) TAPE_ROWS;

#define TAPE_SHORT ->Arg(100)->Arg(1000)->Unit(benchmark::kMillisecond)
#define TAPE_TURNS ->Arg(2)->Arg(8)->Arg(32)->Unit(benchmark::kMillisecond)
// The sizes are calls on what stands before them: no parentheses. NOLINTBEGIN(bugprone-macro-parentheses)
#define TAPE_SOLVERS(shape, sizes, jacobi_sizes)                                              \
  BENCHMARK_CAPTURE(solve, shape##_auto, LinearKind::automatic, Shape::shape) sizes;          \
  BENCHMARK_CAPTURE(solve, shape##_cholesky, LinearKind::cholesky, Shape::shape) sizes;       \
  BENCHMARK_CAPTURE(solve, shape##_strip, LinearKind::pcg_strip, Shape::shape) sizes;         \
  BENCHMARK_CAPTURE(solve, shape##_two_level, LinearKind::pcg_two_level, Shape::shape) sizes; \
  BENCHMARK_CAPTURE(solve, shape##_jacobi, LinearKind::pcg_jacobi, Shape::shape) jacobi_sizes
// NOLINTEND(bugprone-macro-parentheses)
TAPE_SOLVERS(strip, TAPE_ROWS, TAPE_ROWS);
TAPE_SOLVERS(fold, TAPE_ROWS, TAPE_ROWS);
TAPE_SOLVERS(light_strip, TAPE_ROWS, TAPE_SHORT);
TAPE_SOLVERS(light_fold, TAPE_ROWS, TAPE_SHORT);
TAPE_SOLVERS(light_roll, TAPE_TURNS, TAPE_TURNS);
