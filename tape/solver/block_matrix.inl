#include <algorithm>

#include "tape/core/functors.hpp"
#include "tape/solver/block_matrix.hpp"
#include "tape/solver/host_blocks.hpp"

namespace tape::TAPE_SIDE {
namespace block_matrix {
struct KeyDiffers {
  Span<const std::uint64_t> a, b;
  TAPE_HD int operator()(int i) const { return a[i] != b[i]; }
};
struct KeyIsWrong {
  int n;
  Span<const std::uint64_t> keys;
  TAPE_HD int operator()(int i) const {
    const std::uint64_t row = keys[i] >> 32, col = keys[i] & 0xffffffffu;
    return keys[i] != kNoBlock && (row > col || col >= static_cast<std::uint64_t>(n));
  }
};
struct CopyKeys {
  Span<const std::uint64_t> from;
  Span<std::uint64_t> to;
  TAPE_HD void operator()(int i) const { to[i] = from[i]; }
};
/// The slots, and after them one empty contribution for every diagonal block.
struct NumberSlots {
  Span<const std::uint64_t> slot_keys;
  Span<std::uint64_t> keys;
  Span<int> order;
  TAPE_HD void operator()(int i) const {
    keys[i] = i < slot_keys.size ? slot_keys[i] : block_key(i - slot_keys.size, i - slot_keys.size);
    order[i] = i;
  }
};
struct MarkHeads {
  Span<const std::uint64_t> keys;
  Span<int> head;
  TAPE_HD void operator()(int i) const { head[i] = keys[i] != kNoBlock && (i == 0 || keys[i] != keys[i - 1]); }
};
struct ListBlocks {
  Span<const std::uint64_t> keys;
  Span<const int> index;  // heads before i
  Span<std::uint64_t> block_keys;
  Span<int> slot_begin;
  TAPE_HD void operator()(int i) const {
    if (keys[i] == kNoBlock) return;
    if (i == 0 || keys[i] != keys[i - 1]) {
      block_keys[index[i]] = keys[i];
      slot_begin[index[i]] = i;
    }
    if (i + 1 == keys.size || keys[i + 1] == kNoBlock) slot_begin[slot_begin.size - 1] = i + 1;
  }
};
/// Entry 2k is block k, entry 2k + 1 its mirror image; a diagonal block has none, so that key sorts behind all rows.
struct MirrorKeys {
  Span<const std::uint64_t> block_keys;
  Span<std::uint64_t> keys;
  Span<int> ref;
  TAPE_HD void operator()(int k) const {
    const std::uint64_t key = block_keys[k], mirrored = key << 32 | key >> 32;
    keys[2 * k] = key;
    keys[2 * k + 1] = mirrored == key ? kNoBlock : mirrored;
    ref[2 * k] = 2 * k;
    ref[2 * k + 1] = 2 * k + 1;
  }
};
struct FindRows {
  Span<const std::uint64_t> keys;
  Span<int> begin;
  TAPE_HD void operator()(int row) const {
    int low = 0, high = keys.size;
    while (low < high) {
      const int middle = low + (high - low) / 2;
      if (keys[middle] < block_key(row, 0)) {
        low = middle + 1;
      } else {
        high = middle;
      }
    }
    begin[row] = low;
  }
};
struct FillEntries {
  Span<const std::uint64_t> keys;
  Span<const int> ref;
  Span<RowEntry> entries;
  TAPE_HD void operator()(int e) const { entries[e] = {static_cast<int>(keys[e] & 0xffffffffu), ref[e]}; }
};
struct SumSlots {
  Span<const int> slot_begin, order;
  Span<const Mat3> slots;
  Span<Mat3> blocks;
  TAPE_HD void operator()(int k) const {
    Mat3 sum = Mat3::Zero();
    for (int s = slot_begin[k]; s < slot_begin[k + 1]; ++s)
      if (order[s] < slots.size) sum += slots[order[s]];
    blocks[k] = sum;
  }
};
struct MultiplyRow {
  MatrixView a;
  Span<const Vec3> x;
  Span<Vec3> y;
  TAPE_HD void operator()(int i) const { y[i] = a.row_times(i, x); }
};
struct CopyDiagonal {
  MatrixView a;
  Span<Mat3> out;
  TAPE_HD void operator()(int i) const { out[i] = a.block(i, i); }
};
}  // namespace block_matrix

bool SlotGroup::set_pattern(int n, Span<const std::uint64_t> keys, bool with_diagonal) {
  using namespace block_matrix;
  if (n == n_ && keys.size == slot_keys_.size() && reduce(keys.size, 0, KeyDiffers{keys, slot_keys_.span()}, Plus{}) == 0) return false;
  TAPE_CHECK(reduce(keys.size, 0, KeyIsWrong{n, keys}, Plus{}) == 0);
  n_ = n;
  slot_keys_.resize(keys.size);
  parallel_for(keys.size, CopyKeys{keys, slot_keys_.span()});
  const int contributions = keys.size + (with_diagonal ? n : 0);
  sorted_keys_.resize(contributions);
  order_.resize(contributions);
  parallel_for(contributions, NumberSlots{slot_keys_.span(), sorted_keys_.span(), order_.span()});
  sort_by_key(sorted_keys_, order_);
  find_blocks();
  build_rows();
  return true;
}

void SlotGroup::find_blocks() {
  using namespace block_matrix;
  const int contributions = sorted_keys_.size();
  Buffer<int> index;
  index.resize(contributions);
  parallel_for(contributions, MarkHeads{sorted_keys_.span(), index.span()});
  const int blocks = exclusive_scan(index.span());
  block_keys_.resize(blocks);
  slot_begin_.resize(blocks + 1);
  values_.resize(blocks);
  parallel_for(contributions, ListBlocks{sorted_keys_.span(), index.span(), block_keys_.span(), slot_begin_.span()});
}

void SlotGroup::build_rows() {
  using namespace block_matrix;
  const int blocks = block_keys_.size();
  Buffer<std::uint64_t> keys;
  Buffer<int> ref;
  keys.resize(2 * blocks);
  ref.resize(2 * blocks);
  parallel_for(blocks, MirrorKeys{block_keys_.span(), keys.span(), ref.span()});
  sort_by_key(keys, ref);
  row_begin_.resize(n_ + 1);
  parallel_for(n_ + 1, FindRows{keys.span(), row_begin_.span()});
  entries_.resize(read_back(Span<const int>(row_begin_.span()), n_));
  parallel_for(entries_.size(), FillEntries{keys.span(), ref.span(), entries_.span()});
}

void SlotGroup::accumulate(Span<const Mat3> values) {
  TAPE_CHECK(values.size == slots());
  parallel_for(blocks(), block_matrix::SumSlots{slot_begin_.span(), order_.span(), values, values_.span()});
}

void BlockMatrix::set_fixed_pattern(int n, Span<const std::uint64_t> keys) {
  const bool resized = n != n_;
  n_ = n;
  bool changed = fixed_.set_pattern(n, keys, true);
  if (resized) changed |= contact_.set_pattern(n, {}, false);
  if (changed) pattern_ = next_pattern_id();
}

void BlockMatrix::set_contact_pattern(Span<const std::uint64_t> keys) {
  if (contact_.set_pattern(n_, keys, false)) pattern_ = next_pattern_id();
}

void BlockMatrix::multiply(Span<const Vec3> x, Span<Vec3> y) const {
  TAPE_CHECK(x.size == n_ && y.size == n_);
  parallel_for(n_, block_matrix::MultiplyRow{view(), x, y});
}

void BlockMatrix::diagonal(Span<Mat3> out) const {
  TAPE_CHECK(out.size == n_);
  parallel_for(n_, block_matrix::CopyDiagonal{view(), out});
}

void BlockMatrix::download_pattern(HostBlocks& host) const {
  if (host.pattern == pattern_ && host.n == n_) return;
  merge_patterns(n_, fixed_.keys().download(), contact_.keys().download(), host);
  host.pattern = pattern_;
}

void BlockMatrix::download(HostBlocks& host) const {
  download_pattern(host);
  if constexpr (kHostMemory) {
    sum_groups(fixed_.values().span(), contact_.values().span(), host);
  } else {
    const std::vector<Mat3> fixed = fixed_.values().download(), contact = contact_.values().download();
    sum_groups({fixed.data(), fixed_.blocks()}, {contact.data(), contact_.blocks()}, host);
  }
}
}  // namespace tape::TAPE_SIDE
