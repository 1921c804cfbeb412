// Throughput of each effect per element, and what the closed-form projections save against an eigen-decomposition.
#include <benchmark/benchmark.h>

#include <Eigen/Eigenvalues>
#include <chrono>
#include <string>

#include "tape/effects/effects.inl"
#include "tests/support/effect_world.hpp"
using namespace tape;
using namespace tape::test;

namespace {
enum class What { energy, gradient, exact_hessian, projected_hessian };

template <class T, What kWhat>
auto evaluate(const T& term, const StateView& s, int i) {
  if constexpr (kWhat == What::energy) return term.energy(s, i);
  if constexpr (kWhat == What::gradient) return term.gradient(s, i);
  if constexpr (kWhat == What::exact_hessian) return term.hessian(s, i, HessianMode::exact);
  if constexpr (kWhat == What::projected_hessian) return term.hessian(s, i, HessianMode::projected);
}

template <class T, What kWhat>
void per_element(benchmark::State& state) {
  const EffectWorld world(1);
  const Built<T> built(world);
  const StateView s = world.view();
  for (auto _ : state)
    for (int i = 0; i < built.count(); ++i) benchmark::DoNotOptimize(evaluate<T, kWhat>(built.term, s, i));
  state.SetItemsProcessed(state.iterations() * built.count());
}

/// The exact Hessian with its negative eigenvalues cut by the generic solver: what the closed form replaces.
template <class T>
auto generic_projection(const T& term, const StateView& s, int i) {
  using Matrix = decltype(term.hessian(s, i, HessianMode::exact));
  const Eigen::SelfAdjointEigenSolver<Matrix> e(term.hessian(s, i, HessianMode::exact));
  return Matrix(e.eigenvectors() * e.eigenvalues().cwiseMax(0).asDiagonal() * e.eigenvectors().transpose());
}

template <class F>
double seconds(const F& f, int repeats) {
  const auto start = std::chrono::steady_clock::now();
  for (int k = 0; k < repeats; ++k) f();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

/// times_faster: closed form against eigen-decomposition, both from positions to the finished matrix.
template <class T>
void against_eigen_decomposition(benchmark::State& state) {
  const EffectWorld world(1);
  const Built<T> built(world);
  const StateView s = world.view();
  double closed = 0, generic = 0;
  for (auto _ : state) {
    closed += seconds(
        [&] {
          for (int i = 0; i < built.count(); ++i) benchmark::DoNotOptimize(built.term.hessian(s, i, HessianMode::projected));
        },
        10);
    generic += seconds(
        [&] {
          for (int i = 0; i < built.count(); ++i) benchmark::DoNotOptimize(generic_projection(built.term, s, i));
        },
        10);
  }
  state.counters["times_faster"] = generic / closed;
}

const bool kRegistered = [] {
  for_each_effect([]<class T>(std::type_identity<T>) {
    const std::string name(T::name);
    benchmark::RegisterBenchmark((name + "/energy").c_str(), per_element<T, What::energy>);
    benchmark::RegisterBenchmark((name + "/gradient").c_str(), per_element<T, What::gradient>);
    benchmark::RegisterBenchmark((name + "/exact_hessian").c_str(), per_element<T, What::exact_hessian>);
    benchmark::RegisterBenchmark((name + "/projected_hessian").c_str(), per_element<T, What::projected_hessian>);
  });
  benchmark::RegisterBenchmark("barrier/closed_form_against_12x12", against_eigen_decomposition<Barrier>);
  benchmark::RegisterBenchmark("friction/closed_form_against_12x12", against_eigen_decomposition<Friction>);
  benchmark::RegisterBenchmark("membrane/closed_form_against_9x9", against_eigen_decomposition<Membrane>);
  benchmark::RegisterBenchmark("bending/closed_form_against_18x18", against_eigen_decomposition<Bending>);
  return true;
}();
}  // namespace
