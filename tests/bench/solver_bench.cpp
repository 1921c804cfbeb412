#include <benchmark/benchmark.h>

#include "tape/core/execution.hpp"
#include "tape/solver/cholesky.hpp"
#include "tape/solver/cost_model.hpp"
#include "tape/solver/linear_solver.hpp"
#include "tests/support/strip_system.hpp"

/// Cost of the linear part for strips of `rows` rows of 7 vertices: the constants of the cost model (tape/solver/README.md) come
/// from here. One thread; "per_row" is CPU seconds per row, "flops" what the cost model counts.
using namespace tape;
using namespace tape::on_cpu;
using test::StripSystem;

namespace {
struct Loaded {
  StripSystem system;
  BlockMatrix matrix;
  Buffer<std::uint64_t> fixed_keys, contact_keys;
  Buffer<Mat3> fixed_values, contact_values;
  Buffer<Vec3> points, b, x;
  HostBlocks host;
  explicit Loaded(StripSystem s)
      : system(std::move(s)),
        fixed_keys(system.fixed.keys),
        contact_keys(system.contact.keys),
        fixed_values(system.fixed.values),
        contact_values(system.contact.values),
        points(system.x),
        b(system.load()) {
    matrix.set_fixed_pattern(system.n, fixed_keys.span());
    matrix.set_contact_pattern(contact_keys.span());
    matrix.accumulate_fixed(fixed_values.span());
    matrix.accumulate_contact(contact_values.span());
    matrix.download(host);
    x.resize(system.n);
  }
};
StripSystem strip(int rows, bool folded) {
  StripSystem s;
  s.add_strip(rows);
  if (folded) s.fold(0, rows, 1e4);
  return s;
}
Loaded loaded(const benchmark::State& state, bool folded = false) {
  set_threads(1);
  return Loaded(strip(static_cast<int>(state.range(0)), folded));
}

void report(benchmark::State& state, Real items_per_iteration, Real flops = 0) {
  using benchmark::Counter;
  const auto iterations = static_cast<Real>(state.iterations());
  state.counters["blocks_per_s"] = Counter(items_per_iteration * iterations, Counter::kIsRate);
  state.counters["per_row"] = Counter(static_cast<Real>(state.range(0)) * iterations, Counter::kIsRate | Counter::kInvert);
  if (flops > 0) state.counters["flops"] = Counter(flops * iterations, Counter::kIsRate);
}

void pattern(benchmark::State& state) {
  const Loaded a = loaded(state);
  for (auto _ : state) {
    BlockMatrix fresh;
    fresh.set_fixed_pattern(a.system.n, a.fixed_keys.span());
  }
  report(state, a.fixed_keys.size());
}
void accumulate(benchmark::State& state) {
  Loaded a = loaded(state);
  for (auto _ : state) a.matrix.accumulate_fixed(a.fixed_values.span());
  report(state, a.fixed_keys.size());
}
void multiply(benchmark::State& state) {
  Loaded a = loaded(state);
  for (auto _ : state) a.matrix.multiply(a.b.span(), a.x.span());
  report(state, a.matrix.blocks(), 36.0 * a.matrix.blocks());
}
void strip_factor(benchmark::State& state) {
  const Loaded a = loaded(state);
  StripFactor factor(a.system.layout);
  for (auto _ : state) factor.factor(a.host);
  const Real kd = 3 * (2 * StripSystem::kColumns) + 2;
  report(state, a.matrix.blocks(), 3.0 * a.system.n * kd * kd);
}
void strip_solve(benchmark::State& state) {
  Loaded a = loaded(state);
  StripFactor factor(a.system.layout);
  factor.factor(a.host);
  for (auto _ : state) factor.solve(a.b.span(), a.x.span());
  const Real kd = 3 * (2 * StripSystem::kColumns) + 2;
  report(state, a.matrix.blocks(), 4 * 3.0 * a.system.n * kd);
}
void cholesky_analysis(benchmark::State& state) {
  const Loaded a = loaded(state);
  for (auto _ : state) Cholesky().analyze(a.host);
  report(state, a.matrix.blocks());
}
void cholesky_factor(benchmark::State& state) {
  const Loaded a = loaded(state);
  Cholesky cholesky;
  for (auto _ : state) cholesky.factor(a.host);
  report(state, a.matrix.blocks(), cholesky.factor_flops());
}
void cholesky_solve(benchmark::State& state) {
  Loaded a = loaded(state);
  Cholesky cholesky;
  cholesky.factor(a.host);
  for (auto _ : state) cholesky.solve(a.b.span(), a.x.span());
  report(state, a.matrix.blocks(), 4 * cholesky.factor_nonzeros());
}
void cost_model(benchmark::State& state) {
  const Loaded a = loaded(state, true);
  for (auto _ : state) benchmark::DoNotOptimize(linear_costs(a.host, a.system.layout));
  report(state, a.matrix.blocks());
}

/// The whole solve, pattern kept; the label is the solver that ran, its iterations, and what the cost model foresaw.
void solve(benchmark::State& state, LinearKind kind, bool folded) {
  Loaded a = loaded(state, folded);
  LinearSolver solver({.linear = kind}, a.system.layout);
  LinearReport last;
  for (auto _ : state) last = solver.solve(a.matrix, a.points.span(), a.b.span(), a.x.span());
  const LinearCosts costs = linear_costs(a.host, a.system.layout);
  report(state, a.matrix.blocks());
  state.counters["iterations"] = last.iterations;
  state.counters["model_ms"] = 1e3 * (last.solver == "pcg_strip"    ? costs.pcg_strip
                                      : last.solver == "pcg_jacobi" ? costs.pcg_jacobi
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
BENCHMARK(cost_model) TAPE_ROWS;
BENCHMARK_CAPTURE(solve, auto, LinearKind::automatic, false) TAPE_ROWS;
BENCHMARK_CAPTURE(solve, cholesky, LinearKind::cholesky, false) TAPE_ROWS;
BENCHMARK_CAPTURE(solve, jacobi, LinearKind::pcg_jacobi, false) TAPE_ROWS;
BENCHMARK_CAPTURE(solve, folded_auto, LinearKind::automatic, true) TAPE_ROWS;
BENCHMARK_CAPTURE(solve, folded_cholesky, LinearKind::cholesky, true) TAPE_ROWS;
BENCHMARK_CAPTURE(solve, folded_strip, LinearKind::pcg_strip, true) TAPE_ROWS;
BENCHMARK_CAPTURE(solve, folded_jacobi, LinearKind::pcg_jacobi, true) TAPE_ROWS;
