#include <benchmark/benchmark.h>

#include "tape/contact/gap.hpp"
#include "tape/contact/intersection.hpp"
#include "tape/contact/search.hpp"
#include "tests/tape/contact/meshes.hpp"
using namespace tape;
using namespace tape::on_cpu;

/// Contact search, distances, CCD and the exact check on one thread; items are pairs, or triangles for the check.
/// Argument 0: a roll of 32 turns, pitch 0.27 mm, rows of 7 vertices; 1: a strip folded into 24 layers.
namespace {
constexpr Real kDhat = 1.8e-4, kXi = 4.5e-5;  // [m]
constexpr Real kMargin = 3e-5;                // [m] slack of the trust boxes

struct Scene {
  test::Surface surface;
  Buffer<Vec3> x, direction, bodies;
  Buffer<VertexOwner> owner;
  ContactSearch search;
  explicit Scene(test::Surface s) : surface(std::move(s)), x(surface.x), owner(surface.mesh.owner), search(surface.mesh, kDhat, kDhat) {
    std::vector<Vec3> d;  // a smooth motion of a fraction of the gap, as Newton iterations have it
    for (const Vec3& p : surface.x) d.push_back(3e-5 * Vec3(std::sin(300 * p.y()), std::cos(500 * p.x()), std::sin(700 * p.z())));
    direction.upload(d);
    search.rebuild(paths(), kMargin);
  }
  PathView paths() const { return {x.span(), owner.span(), direction.span(), bodies.span()}; }
  int pairs() const { return search.candidates().size; }
};
Scene& scene(benchmark::State& state) {
  static Scene roll(test::wound_strip(32, 2.7e-4, kXi));
  static Scene fold(test::folded_strip(24, 64, 2.7e-4, kXi));
  set_threads(1);
  state.SetLabel(state.range(0) == 0 ? "roll" : "fold");
  return state.range(0) == 0 ? roll : fold;
}

void FindCandidates(benchmark::State& state) {
  Scene& s = scene(state);
  for (auto _ : state) s.search.rebuild(s.paths(), kMargin);
  state.SetItemsProcessed(state.iterations() * s.pairs());
  state.counters["pairs"] = s.pairs();
}
void ReuseCandidates(benchmark::State& state) {
  Scene& s = scene(state);
  for (auto _ : state) benchmark::DoNotOptimize(s.search.update(s.paths(), kMargin));
  state.SetItemsProcessed(state.iterations() * s.pairs());
}
void Distances(benchmark::State& state) {
  Scene& s = scene(state);
  for (auto _ : state) benchmark::DoNotOptimize(smallest_gap(s.search.candidates(), s.x.span()));
  state.SetItemsProcessed(state.iterations() * s.pairs());
}
void StepLimits(benchmark::State& state) {
  Scene& s = scene(state);
  Real limit = 0;
  for (auto _ : state) limit = s.search.limit_steps(s.paths(), {})[0];
  state.SetItemsProcessed(state.iterations() * s.pairs());
  state.counters["limit"] = limit;
}
void ExactCheck(benchmark::State& state) {
  Scene& s = scene(state);
  for (auto _ : state) benchmark::DoNotOptimize(find_intersections(s.surface.mesh, s.surface.x));
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(s.surface.mesh.triangles.size()));
}
}  // namespace
BENCHMARK(FindCandidates)->DenseRange(0, 1)->Unit(benchmark::kMillisecond);
BENCHMARK(ReuseCandidates)->DenseRange(0, 1)->Unit(benchmark::kMillisecond);
BENCHMARK(Distances)->DenseRange(0, 1)->Unit(benchmark::kMillisecond);
BENCHMARK(StepLimits)->DenseRange(0, 1)->Unit(benchmark::kMillisecond);
BENCHMARK(ExactCheck)->DenseRange(0, 1)->Unit(benchmark::kMillisecond);
