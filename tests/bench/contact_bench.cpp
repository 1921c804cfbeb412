#include <benchmark/benchmark.h>

#include <optional>

#include "tape/contact/gap.hpp"
#include "tape/contact/intersection.hpp"
#include "tape/contact/search.hpp"
#include "tape/solver/objective.inl"
#include "tests/tape/contact/meshes.hpp"
using namespace tape;
using namespace tape::on_cpu;

/// Contact search, distances, barrier, CCD and the exact check; items are candidate pairs, for the barrier's gradient and Hessian
/// the active ones, for the check triangles.
/// Argument 0: a roll of 32 turns, pitch 0.27 mm, rows of 7 vertices; 1: a strip folded into 24 layers. Argument 1: threads.
namespace {
constexpr Real kDhat = 1.8e-4, kXi = 4.5e-5;  // [m]
constexpr Real kMargin = 3e-5;                // [m] slack of the trust boxes

/// The barrier with its sums: 3-vectors by vertex, 3x3 blocks by pair of vertices.
class Barriers {
 public:
  Barriers(Span<const ContactPair> candidates, const StateView& s) : term_{candidates} {
    std::vector<int> active;
    std::vector<std::uint64_t> rows, keys;
    for (int i = 0; i < candidates.size; ++i) {
      if (!term_.active(s, i)) continue;
      active.push_back(i);
      const Stencil<4> v = term_.stencil(i);
      for (int a = 0; a < 4; ++a) rows.push_back(static_cast<std::uint64_t>(v.id[a]));
      for (int a = 0; a < 4; ++a)
        for (int b = a; b < 4; ++b) keys.push_back(block_key(std::min(v.id[a], v.id[b]), std::max(v.id[a], v.id[b])));
    }
    active_.upload(active);
    gather_.set_rows(s.x.size, Buffer<std::uint64_t>(rows));
    blocks_.set_pattern(s.x.size, Buffer<std::uint64_t>(keys).span(), false);
    forces_.resize(4 * size()), stiffness_.resize(10 * size()), gradient_.resize(s.x.size);
  }
  int size() const { return active_.size(); }
  void gradient(const StateView& s) {
    parallel_for(size(), Gradient{term_, s, active_.span(), forces_.span()});
    gather_.gather(forces_.span(), false, gradient_.span());
  }
  void hessian(const StateView& s) {
    parallel_for(size(), Hessian{term_, s, active_.span(), stiffness_.span()});
    blocks_.accumulate(stiffness_.span());
  }

 private:
  struct Gradient {
    Barrier term;
    StateView s;
    Span<const int> active;
    Span<Vec3> slots;
    void operator()(int i) const {
      const VecN<12> g = term.gradient(s, active[i]);
      for (int a = 0; a < 4; ++a) slots[4 * i + a] = g.segment<3>(3 * a);
    }
  };
  struct Hessian {
    Barrier term;
    StateView s;
    Span<const int> active;
    Span<Mat3> slots;
    void operator()(int i) const {
      const MatN<12, 12> h = term.hessian(s, active[i], HessianMode::projected);
      const Stencil<4> v = term.stencil(active[i]);
      for (int a = 0; a < 4; ++a)
        for (int b = a; b < 4; ++b)
          slots[10 * i + pair_slot(a, b, 4)] = v.id[a] <= v.id[b] ? h.block<3, 3>(3 * a, 3 * b) : h.block<3, 3>(3 * b, 3 * a);
    }
  };
  Barrier term_;
  Buffer<int> active_;
  VectorGather gather_;
  SlotGroup blocks_;
  Buffer<Vec3> forces_, gradient_;
  Buffer<Mat3> stiffness_;
};

struct Scene {
  test::Surface surface;
  Buffer<Vec3> x, direction;
  Buffer<Pose> bodies;
  Buffer<VertexOwner> owner;
  ContactSearch search;
  std::optional<Barriers> barriers;
  std::optional<Objective> potential;  // of the barrier alone; each vertex is a block of unknowns
  explicit Scene(test::Surface s) : surface(std::move(s)), x(surface.x), owner(surface.mesh.owner), search(surface.mesh, kDhat, kDhat / 2) {
    std::vector<Vec3> d;  // a smooth motion of a fraction of the gap, as Newton iterations have it
    for (const Vec3& p : surface.x) d.push_back(3e-5 * Vec3(std::sin(300 * p.y()), std::cos(500 * p.x()), std::sin(700 * p.z())));
    direction.upload(d);
    search.rebuild(paths(), kMargin);
    barriers.emplace(search.candidates(), view());
    tape::Scene empty;
    empty.contact.dhat = kDhat;
    Assembly assembly;
    assembly.blocks = x.size();
    std::vector<bool> on;
    for_each_effect([&]<class T>(std::type_identity<T>) { on.push_back(T::name == Barrier::name); });
    potential.emplace(empty, EffectParams{}, assembly, on);
  }
  PathView paths() const { return {x.span(), owner.span(), direction.span(), bodies.span()}; }
  StateView view() const {
    StateView s{};
    s.dt = 0.01;
    s.x = s.x_start = s.x_tilde = x.span();
    s.owner = owner.span();
    return s;
  }
  int pairs() const { return search.candidates().size; }
};
Scene& scene(benchmark::State& state) {
  static Scene roll(test::wound_strip(32, 2.7e-4, kXi));
  static Scene fold(test::folded_strip(24, 64, 2.7e-4, kXi));
  set_threads(static_cast<int>(state.range(1)));
  state.SetLabel(state.range(0) == 0 ? "roll" : "fold");
  return state.range(0) == 0 ? roll : fold;
}
void count(benchmark::State& state, std::int64_t items) {
  state.SetItemsProcessed(state.iterations() * items);
  state.counters["items"] = static_cast<double>(items);
}

void FindCandidates(benchmark::State& state) {
  Scene& s = scene(state);
  for (auto _ : state) s.search.rebuild(s.paths(), kMargin);
  count(state, s.pairs());
}
void ReuseCandidates(benchmark::State& state) {
  Scene& s = scene(state);
  for (auto _ : state) benchmark::DoNotOptimize(s.search.update(s.paths(), kMargin));
  count(state, s.pairs());
}
void Distances(benchmark::State& state) {
  Scene& s = scene(state);
  for (auto _ : state) benchmark::DoNotOptimize(smallest_gap(s.search.candidates(), s.x.span()));
  count(state, s.pairs());
}
void BarrierEnergy(benchmark::State& state) {
  Scene& s = scene(state);
  s.potential->set_candidates(s.search.candidates());
  for (auto _ : state) benchmark::DoNotOptimize(s.potential->energy(s.view()));
  count(state, s.pairs());
}
void BarrierGradient(benchmark::State& state) {
  Scene& s = scene(state);
  for (auto _ : state) s.barriers->gradient(s.view());
  count(state, s.barriers->size());
}
void BarrierHessian(benchmark::State& state) {
  Scene& s = scene(state);
  for (auto _ : state) s.barriers->hessian(s.view());
  count(state, s.barriers->size());
}
/// What a Newton iteration does: the active pairs, their places in the sums, gradient and projected Hessian.
void BarrierSystem(benchmark::State& state) {
  Scene& s = scene(state);
  s.potential->set_candidates(s.search.candidates());
  for (auto _ : state) s.potential->linearize(s.view(), HessianMode::projected);
  count(state, s.pairs());
}
void StepLimits(benchmark::State& state) {
  Scene& s = scene(state);
  Real limit = 0;
  for (auto _ : state) limit = s.search.limit_steps(s.paths(), {})[0];
  count(state, s.pairs());
  state.counters["limit"] = limit;
}
void ExactCheck(benchmark::State& state) {
  Scene& s = scene(state);
  for (auto _ : state) benchmark::DoNotOptimize(find_intersections(s.surface.mesh, s.surface.x));
  count(state, static_cast<std::int64_t>(s.surface.mesh.triangles.size()));
}
}  // namespace

#define TAPE_SURFACES ->ArgsProduct({{0, 1}, {1, 2}})->ArgNames({"", "threads"})->Unit(benchmark::kMillisecond)->UseRealTime()
BENCHMARK(FindCandidates) TAPE_SURFACES;
BENCHMARK(ReuseCandidates) TAPE_SURFACES;
BENCHMARK(Distances) TAPE_SURFACES;
BENCHMARK(BarrierEnergy) TAPE_SURFACES;
BENCHMARK(BarrierGradient) TAPE_SURFACES;
BENCHMARK(BarrierHessian) TAPE_SURFACES;
BENCHMARK(BarrierSystem) TAPE_SURFACES;
BENCHMARK(StepLimits) TAPE_SURFACES;
BENCHMARK(ExactCheck) TAPE_SURFACES;
