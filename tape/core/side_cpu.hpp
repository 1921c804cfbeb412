#pragma once
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cstdint>
#include <memory>
#include <numeric>
#include <random>
#include <typeinfo>
#include <vector>

#include "tape/core/error.hpp"
#include "tape/core/execution.hpp"
#include "tape/core/types.hpp"

namespace tape::on_cpu {
inline bool available() { return true; }
/// Whether Span of this side points to memory of the host.
inline constexpr bool kHostMemory = true;

/// Array in the memory of this side. Grows, never shrinks its capacity; contents after `resize` are unspecified.
template <class T>
class Buffer {
 public:
  Buffer() = default;
  explicit Buffer(const std::vector<T>& host) { upload(host); }
  Buffer(Buffer&&) noexcept = default;
  Buffer& operator=(Buffer&&) noexcept = default;
  int size() const { return size_; }
  void resize(int n) {
    if (n > capacity_) {
      capacity_ = std::max(n, capacity_ + capacity_ / 2);
      data_ = std::make_unique_for_overwrite<T[]>(static_cast<std::size_t>(capacity_));
    }
    size_ = n;
  }
  void upload(const std::vector<T>& host) {
    resize(static_cast<int>(host.size()));
    std::copy(host.begin(), host.end(), data_.get());
  }
  std::vector<T> download() const { return {data_.get(), data_.get() + size_}; }
  void copy_from(const Buffer& other) {
    resize(other.size_);
    std::copy_n(other.data_.get(), size_, data_.get());
  }
  Span<T> span() { return {data_.get(), size_}; }
  Span<const T> span() const { return {data_.get(), size_}; }

 private:
  std::unique_ptr<T[]> data_;
  int size_ = 0, capacity_ = 0;
};

namespace detail {
inline constexpr int kChunk = 256;  // iterations per task; part of the definition of a sum, so it is fixed
inline int chunk_count(int n, int size = kChunk) { return (n + size - 1) / size; }

template <class F>
void for_chunks(int n, const F& f, int size = kChunk) {  // f(chunk, begin, end)
  const auto run = [&](int c) { f(c, c * size, std::min(n, (c + 1) * size)); };
  const int chunks = chunk_count(n, size);
  if (chunks <= 1 || threads() == 1) {
    for (int c = 0; c < chunks; ++c) run(c);
  } else {
    tbb::parallel_for(0, chunks, run);
  }
}
}  // namespace detail

/// Iterations per task of kernels that take about a microsecond each.
inline constexpr int kFew = 32;

/// Calls k(i) for i in [0, n). Iterations must not depend on one another.
/// @param task  iterations per task
template <class Kernel>
void parallel_for(int n, Kernel k, int task = detail::kChunk) {
  if (n <= 0) return;
  if (recording_launches()) note_launch(typeid(Kernel).name());
  if (const std::uint64_t seed = shuffled_order()) {
    std::vector<int> order(static_cast<std::size_t>(n));
    std::iota(order.begin(), order.end(), 0);
    std::shuffle(order.begin(), order.end(), std::mt19937_64(seed));
    for (int i : order) k(i);
    return;
  }
  const auto run = [&](int, int begin, int end) {
    for (int i = begin; i < end; ++i) k(i);
  };
  detail::for_chunks(n, run, task);
}

/// k(0) (+) k(1) (+) ... over fixed chunks in fixed order: same bits for any number of threads.
/// `combine` is a stateless functor on values; `identity` its neutral element.
template <class T, class Kernel, class Combine>
T reduce(int n, T identity, Kernel k, Combine combine) {
  if (n <= 0) return identity;
  if (recording_launches()) note_launch(typeid(Kernel).name());
  const int chunks = detail::chunk_count(n);
  const auto partial = std::make_unique<T[]>(static_cast<std::size_t>(chunks));  // no vector: bits of vector<bool> share bytes
  detail::for_chunks(n, [&](int c, int begin, int end) {
    T sum = identity;
    for (int i = begin; i < end; ++i) sum = combine(sum, k(i));
    partial[c] = sum;
  });
  T sum = identity;
  for (int c = 0; c < chunks; ++c) sum = combine(sum, partial[c]);
  return sum;
}

/// In place: values[i] becomes the sum of those before it; returns the sum of all.
inline int exclusive_scan(Span<int> values) {
  int sum = 0;
  for (int& v : values) sum += std::exchange(v, sum);
  return sum;
}

/// Sorts keys ascending and moves the values with them; equal keys keep their order.
inline void sort_by_key(Buffer<std::uint64_t>& keys, Buffer<int>& values) {
  constexpr int kBits = 8, kBins = 1 << kBits;
  const int n = keys.size(), chunk = 16384, chunks = (n + chunk - 1) / chunk;
  TAPE_CHECK(values.size() == n);
  std::uint64_t all_or = 0, all_and = ~std::uint64_t{0};
  for (std::uint64_t k : keys.span()) all_or |= k, all_and &= k;
  Buffer<std::uint64_t> other_keys;
  Buffer<int> other_values;
  other_keys.resize(n), other_values.resize(n);
  std::vector<std::array<int, kBins>> counts(static_cast<std::size_t>(chunks));
  for (int shift = 0; shift < 64; shift += kBits) {
    if ((((all_or ^ all_and) >> shift) & (kBins - 1)) == 0) continue;  // a digit that all keys share
    const auto digit = [shift](std::uint64_t k) { return static_cast<std::size_t>((k >> shift) & (kBins - 1)); };
    const Span<std::uint64_t> k_in = keys.span(), k_out = other_keys.span();
    const Span<int> v_in = values.span(), v_out = other_values.span();
    tbb::parallel_for(0, chunks, [&](int c) {
      auto& count = counts[static_cast<std::size_t>(c)];
      count.fill(0);
      for (int i = c * chunk; i < std::min(n, (c + 1) * chunk); ++i) ++count[digit(k_in[i])];
    });
    int sum = 0;
    for (std::size_t d = 0; d < kBins; ++d)
      for (auto& count : counts) sum += std::exchange(count[d], sum);
    tbb::parallel_for(0, chunks, [&](int c) {
      auto& next = counts[static_cast<std::size_t>(c)];
      for (int i = c * chunk; i < std::min(n, (c + 1) * chunk); ++i) {
        const int to = next[digit(k_in[i])]++;
        k_out[to] = k_in[i];
        v_out[to] = v_in[i];
      }
    });
    std::swap(keys, other_keys);
    std::swap(values, other_values);
  }
}

/// *target = min(*target, value), safe from many iterations: the minimum does not depend on their order.
inline void atomic_min(Real* target, Real value) {
  std::atomic_ref<Real> ref(*target);
  Real seen = ref.load(std::memory_order_relaxed);
  while (value < seen && !ref.compare_exchange_weak(seen, value, std::memory_order_relaxed)) {
  }
}

/// Reads or writes one element of an array of this side from the host.
template <class T>
T read_back(Span<const T> from, int i) {
  return from[i];
}
}  // namespace tape::on_cpu
