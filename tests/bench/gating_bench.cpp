// Off is never slower than a coefficient of zero: `off_over_zero` is the median, over pairs of runs that alternate, of the time of twenty
// steps with the effect off over that with its coefficient zero (checks.md part 10, E1).
#include <benchmark/benchmark.h>

#include <algorithm>
#include <vector>

#include "tests/support/gating.hpp"
using namespace tape;
using namespace tape::test;

namespace {
Real time_of(const Setup& setup) {  // [ms]
  Simulation simulation(setup);
  simulation.check_intersections = false;
  Real ms = 0;
  for (int k = 0; k < 20; ++k) ms += simulation.step().wall_ms;
  return ms;
}
void compare(benchmark::State& state, const Setup& off, const Setup& zero) {
  std::vector<Real> ratio;
  for (auto _ : state) ratio.push_back(time_of(off) / time_of(zero));
  std::nth_element(ratio.begin(), ratio.begin() + static_cast<std::ptrdiff_t>(ratio.size() / 2), ratio.end());
  state.counters["off_over_zero"] = ratio[ratio.size() / 2];
}
BENCHMARK_CAPTURE(compare, friction, without(draped(), {"friction"}), frictionless())->Iterations(11);
BENCHMARK_CAPTURE(compare, contact, without(swinging(), {"barrier", "friction"}), swinging())->Iterations(11);
BENCHMARK_CAPTURE(compare, bending, without(swinging(), {"bending"}), limp())->Iterations(11);
}  // namespace
