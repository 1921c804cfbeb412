#pragma once
#include <cuda_runtime.h>
#include <thrust/execution_policy.h>
#include <thrust/scan.h>
#include <thrust/sort.h>

#include <algorithm>
#include <climits>
#include <cstdint>
#include <new>
#include <string>
#include <utility>
#include <vector>

#include "tape/core/error.hpp"
#include "tape/core/types.hpp"

namespace tape::on_cuda {
namespace detail {
inline __global__ void nothing() {}
}  // namespace detail
/// Whether there is a device, of an architecture that this program was compiled for.
inline bool available() {
  int n = 0;
  cudaFuncAttributes compiled;
  return cudaGetDeviceCount(&n) == cudaSuccess && n > 0 && cudaFuncGetAttributes(&compiled, detail::nothing) == cudaSuccess;
}
/// Whether Span of this side points to memory of the host.
inline constexpr bool kHostMemory = false;
inline void require(cudaError_t status) {
  if (status == cudaErrorMemoryAllocation) throw std::bad_alloc();
  if (status != cudaSuccess) throw CheckFailed(std::string("CUDA: ") + cudaGetErrorString(status));
}

/// Array in the memory of this side. Grows, never shrinks its capacity; contents after `resize` are unspecified.
template <class T>
class Buffer {
 public:
  Buffer() = default;
  explicit Buffer(const std::vector<T>& host) { upload(host); }
  Buffer(Buffer&& o) noexcept
      : data_(std::exchange(o.data_, nullptr)), size_(std::exchange(o.size_, 0)), capacity_(std::exchange(o.capacity_, 0)) {}
  Buffer& operator=(Buffer&& o) noexcept {
    std::swap(data_, o.data_), std::swap(size_, o.size_), std::swap(capacity_, o.capacity_);
    return *this;
  }
  ~Buffer() { cudaFree(data_); }
  int size() const { return size_; }
  void resize(int n) {
    if (n > capacity_) {
      const int grown = static_cast<int>(std::min<long long>(std::max<long long>(n, capacity_ + capacity_ / 2LL), INT_MAX));
      capacity_ = 0;
      require(cudaFree(std::exchange(data_, nullptr)));
      require(cudaMalloc(reinterpret_cast<void**>(&data_), sizeof(T) * static_cast<std::size_t>(grown)));
      capacity_ = grown;
    }
    size_ = n;
  }
  void upload(const std::vector<T>& host) {
    resize(static_cast<int>(host.size()));
    if (size_ > 0) require(cudaMemcpy(data_, host.data(), bytes(), cudaMemcpyHostToDevice));
  }
  std::vector<T> download() const {
    std::vector<T> host(static_cast<std::size_t>(size_));
    if (size_ > 0) require(cudaMemcpy(host.data(), data_, bytes(), cudaMemcpyDeviceToHost));
    return host;
  }
  void copy_from(const Buffer& other) {
    resize(other.size_);
    if (size_ > 0) require(cudaMemcpy(data_, other.data_, bytes(), cudaMemcpyDeviceToDevice));
  }
  Span<T> span() { return {data_, size_}; }
  Span<const T> span() const { return {data_, size_}; }

 private:
  std::size_t bytes() const { return sizeof(T) * static_cast<std::size_t>(size_); }
  T* data_ = nullptr;
  int size_ = 0, capacity_ = 0;
};

namespace detail {
inline constexpr int kThreads = 256;
template <class Kernel>
__global__ void run(int n, Kernel k) {
  if (const int i = static_cast<int>(blockIdx.x * blockDim.x + threadIdx.x); i < n) k(i);
}
template <class T, class Kernel, class Combine>
__global__ void reduce_blocks(int n, T identity, Kernel k, Combine combine, T* partial) {
  __shared__ alignas(alignof(T)) unsigned char memory[sizeof(T) * kThreads];
  T* shared = reinterpret_cast<T*>(memory);
  const int i = static_cast<int>(blockIdx.x * blockDim.x + threadIdx.x);
  shared[threadIdx.x] = i < n ? k(i) : identity;
  for (int half = kThreads / 2; half > 0; half /= 2) {
    __syncthreads();
    if (static_cast<int>(threadIdx.x) < half) shared[threadIdx.x] = combine(shared[threadIdx.x], shared[threadIdx.x + half]);
  }
  if (threadIdx.x == 0) partial[blockIdx.x] = shared[0];
}
template <class T, class Combine>
__global__ void combine_partials(int n, T identity, Combine combine, T* partial) {
  T sum = identity;
  for (int i = 0; i < n; ++i) sum = combine(sum, partial[i]);
  partial[0] = sum;
}
inline unsigned blocks(int n) { return static_cast<unsigned>((n + kThreads - 1) / kThreads); }
}  // namespace detail

inline constexpr int kFew = 32;  ///< as on the CPU

/// Calls k(i) for i in [0, n). Iterations must not depend on one another. The last parameter means nothing here.
template <class Kernel>
void parallel_for(int n, Kernel k, int = 0) {
  if (n <= 0) return;
  detail::run<<<detail::blocks(n), detail::kThreads>>>(n, k);
  require(cudaGetLastError());
}

/// k(0) (+) k(1) (+) ... as a fixed tree: repeats to the bit.
template <class T, class Kernel, class Combine>
T reduce(int n, T identity, Kernel k, Combine combine) {
  if (n <= 0) return identity;
  Buffer<T> partial;
  partial.resize(static_cast<int>(detail::blocks(n)));
  detail::reduce_blocks<<<detail::blocks(n), detail::kThreads>>>(n, identity, k, combine, partial.span().data);
  detail::combine_partials<<<1, 1>>>(partial.size(), identity, combine, partial.span().data);
  require(cudaGetLastError());
  T sum = identity;
  require(cudaMemcpy(&sum, partial.span().data, sizeof(T), cudaMemcpyDeviceToHost));
  return sum;
}

/// In place: values[i] becomes the sum of those before it; returns the sum of all.
inline int exclusive_scan(Span<int> values) {
  if (values.size == 0) return 0;
  int last = 0, sum = 0;
  require(cudaMemcpy(&last, values.end() - 1, sizeof(int), cudaMemcpyDeviceToHost));
  thrust::exclusive_scan(thrust::device, values.begin(), values.end(), values.begin());
  require(cudaMemcpy(&sum, values.end() - 1, sizeof(int), cudaMemcpyDeviceToHost));
  return sum + last;
}

/// Sorts keys ascending and moves the values with them; equal keys keep their order.
inline void sort_by_key(Buffer<std::uint64_t>& keys, Buffer<int>& values) {
  const Span<std::uint64_t> k = keys.span();
  thrust::stable_sort_by_key(thrust::device, k.begin(), k.end(), values.span().begin());
}

/// *target = min(*target, value) for values >= 0, whose bits order like integers.
TAPE_HD inline void atomic_min(Real* target, Real value) {
#ifdef __CUDA_ARCH__
  atomicMin(reinterpret_cast<unsigned long long*>(target), static_cast<unsigned long long>(__double_as_longlong(value)));
#else
  *target = value < *target ? value : *target;  // the host pass of nvcc never runs kernels
#endif
}

/// Reads one element of an array of this side from the host.
template <class T>
T read_back(Span<const T> from, int i) {
  T value;
  require(cudaMemcpy(&value, from.data + i, sizeof(T), cudaMemcpyDeviceToHost));
  return value;
}
}  // namespace tape::on_cuda
