#include <benchmark/benchmark.h>

#include "tape/contact/search.hpp"
#include "tests/tape/contact/meshes.hpp"
using namespace tape;
using namespace tape::on_cpu;

/// Contact search, narrow phase and CCD, on one thread: time per element, so that meshes of any size compare.
namespace {
constexpr Real kDhat = 1.8e-4, kXi = 4.5e-5;  // [m]

struct Scene {
  test::Surface surface;
  Buffer<Vec3> x, direction, bodies;
  Buffer<VertexOwner> owner;
  explicit Scene(test::Surface s) : surface(std::move(s)), x(surface.x), owner(surface.mesh.owner) {
    std::vector<Vec3> d;  // a smooth motion of about a gap, as late Newton iterations have it
    for (const Vec3& p : surface.x) d.push_back(3e-5 * Vec3(std::sin(300 * p.y()), std::cos(500 * p.x()), std::sin(700 * p.z())));
    direction.upload(d);
  }
  PathView paths() const { return {x.span(), owner.span(), direction.span(), bodies.span()}; }
};
/// 0: a roll of 32 turns, pitch 0.27 mm; 1: a strip folded into 24 layers.
Scene& scene(int which) {
  static Scene roll(test::wound_strip(32, 2.7e-4, kXi));
  static Scene fold(test::folded_strip(24, 64, 2.7e-4, kXi));
  return which == 0 ? roll : fold;
}
void label(benchmark::State& state, int elements, const char* what) {
  state.SetItemsProcessed(state.iterations() * elements);
  state.counters[what] = elements;
  state.SetLabel(state.range(0) == 0 ? "roll" : "fold");
}

void Candidates(benchmark::State& state) {
  Scene& s = scene(static_cast<int>(state.range(0)));
  set_threads(1);
  int n = 0;
  ContactSearch search(s.surface.mesh, kDhat);
  for (auto _ : state) {
    // A margin that the paths of the round before leave: every update rebuilds.
    search.update(s.paths(), n % 2 == 0 ? 0.0 : 1e-9);
    n = search.candidates().size;
    state.PauseTiming();
    ContactSearch(s.surface.mesh, kDhat);
    state.ResumeTiming();
  }
  label(state, n, "candidates");
}
}  // namespace
BENCHMARK(Candidates)->DenseRange(0, 1)->Unit(benchmark::kMillisecond);
BENCHMARK_MAIN();
