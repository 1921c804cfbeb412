#pragma once
#include "tape/core/side.hpp"
#include "tape/core/types.hpp"

namespace tape::TAPE_SIDE {
namespace gathering {
struct Iota {
  Span<int> order;
  TAPE_HD void operator()(int i) const { order[i] = i; }
};
struct LowerBound {
  Span<const std::uint64_t> sorted;
  Span<int> begin;
  TAPE_HD void operator()(int row) const {
    int low = 0, high = sorted.size;
    while (low < high) {
      const int middle = (low + high) / 2;
      if (sorted[middle] < static_cast<std::uint64_t>(row)) {
        low = middle + 1;
      } else {
        high = middle;
      }
    }
    begin[row] = low;
  }
};
struct Sum {
  Span<const int> begin, order;
  Span<const Vec3> slots;
  bool add;
  Span<Vec3> out;
  TAPE_HD void operator()(int row) const {
    Vec3 sum = Vec3::Zero();
    for (int k = begin[row]; k < begin[row + 1]; ++k) sum += slots[order[k]];
    if (add) sum += out[row];
    out[row] = sum;
  }
};
}  // namespace gathering

/// Sums slots of 3-vectors into rows, in the order of the slots: same bits for any number of threads.
class VectorGather {
 public:
  /// @param rows  [slots] row of each slot, in [0, n)
  void set_rows(int n, const Buffer<std::uint64_t>& rows) {
    sorted_.copy_from(rows);
    order_.resize(rows.size());
    parallel_for(rows.size(), gathering::Iota{order_.span()});
    sort_by_key(sorted_, order_);
    begin_.resize(n + 1);
    parallel_for(n + 1, gathering::LowerBound{sorted_.span(), begin_.span()});
  }
  /// out[row] = sum of its slots, or added to out with `add`.
  void gather(Span<const Vec3> slots, bool add, Span<Vec3> out) const {
    parallel_for(out.size, gathering::Sum{begin_.span(), order_.span(), slots, add, out});
  }

 private:
  Buffer<std::uint64_t> sorted_;
  Buffer<int> order_, begin_;
};
}  // namespace tape::TAPE_SIDE
