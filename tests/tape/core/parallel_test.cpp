#include <gtest/gtest.h>

#include <random>

#include "tape/core/side.hpp"
using namespace tape;
using namespace tape::on_cpu;

namespace {
struct Value {
  Span<const Real> values;
  Real operator()(int i) const { return values[i]; }
};
struct Plus {
  Real operator()(Real a, Real b) const { return a + b; }
};
struct IsOne {
  int one;
  bool operator()(int i) const { return i == one; }
};
struct Or {
  bool operator()(bool a, bool b) const { return a || b; }
};
struct Square {
  Span<Real> values;
  void operator()(int i) const { values[i] *= values[i]; }
};
std::vector<Real> random_reals(int n) {
  std::mt19937_64 generator(7);
  std::uniform_real_distribution<Real> uniform(-1, 1);
  std::vector<Real> values(static_cast<std::size_t>(n));
  for (Real& v : values) v = uniform(generator) * std::pow(10, 8 * uniform(generator));
  return values;
}
}  // namespace

TEST(Parallel, ASumHasTheSameBitsForAnyNumberOfThreads) {
  Buffer<Real> values(random_reals(100'003));
  set_threads(1);
  const Real one = reduce(values.size(), 0.0, Value{values.span()}, Plus{});
  for (int threads : {2, 8}) {
    set_threads(threads);
    EXPECT_EQ(one, reduce(values.size(), 0.0, Value{values.span()}, Plus{})) << threads << " threads";
  }
  set_threads(0);
}

TEST(Parallel, ReducedFlagsAreNotLostBetweenThreads) {  // chunks that write bits of one byte at a time would lose some
  set_threads(8);
  for (int repeat = 0; repeat < 2000; ++repeat) EXPECT_TRUE(reduce(64 * 256, false, IsOne{repeat * 8}, Or{})) << repeat;
  set_threads(0);
}
TEST(Parallel, ShuffledOrderVisitsEveryIterationOnce) {
  const std::vector<Real> host = random_reals(1000);
  Buffer<Real> values(host);
  set_shuffled_order(3);
  parallel_for(values.size(), Square{values.span()});
  set_shuffled_order(0);
  for (std::size_t i = 0; i < host.size(); ++i) EXPECT_EQ(values.span()[static_cast<int>(i)], host[i] * host[i]);
}

TEST(Parallel, ShuffledOrderShowsAKernelThatReadsItsNeighbour) {
  struct Chain {  // wrong on purpose: iteration i reads what iteration i - 1 wrote
    Span<int> values;
    void operator()(int i) const { values[i] = i == 0 ? 1 : values[i - 1] + 1; }
  };
  const auto run = [](std::uint64_t seed) {
    Buffer<int> values(std::vector<int>(1000, 0));
    set_shuffled_order(seed);
    parallel_for(values.size(), Chain{values.span()});
    set_shuffled_order(0);
    return values.download();
  };
  EXPECT_NE(run(1), run(2));
}

TEST(Parallel, SortIsStableAndComplete) {
  std::mt19937_64 generator(5);
  std::vector<std::uint64_t> keys(70'000);
  for (auto& k : keys) k = (generator() % 50) << 33 | (generator() % 40);
  std::vector<int> values(keys.size());
  std::iota(values.begin(), values.end(), 0);
  auto expected = values;
  std::stable_sort(expected.begin(), expected.end(),
                   [&](int a, int b) { return keys[static_cast<std::size_t>(a)] < keys[static_cast<std::size_t>(b)]; });
  Buffer<std::uint64_t> k(keys);
  Buffer<int> v(values);
  sort_by_key(k, v);
  EXPECT_EQ(v.download(), expected);
  EXPECT_TRUE(std::is_sorted(k.span().begin(), k.span().end()));
}

TEST(Parallel, ExclusiveScanSumsWhatStandsBefore) {
  Buffer<int> values(std::vector<int>{3, 0, 2, 5});
  EXPECT_EQ(exclusive_scan(values.span()), 10);
  EXPECT_EQ(values.download(), (std::vector<int>{0, 3, 3, 5}));
}
