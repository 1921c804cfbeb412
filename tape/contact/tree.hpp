#pragma once
#include <bit>
#include <cstdint>

#include "tape/contact/box.hpp"
#include "tape/core/side.hpp"

/// Bounding volume hierarchy: an implicit complete tree over boxes in Morton order, eight children to a node. Level 0 holds the
/// boxes themselves, eight to a node; node i of a level holds the boxes of nodes 8 i .. 8 i + 7 of the level below; the last level is one
/// node. Nothing depends on the number of threads.
namespace tape::TAPE_SIDE {
inline constexpr int kMaxLevels = 8;  // 8^8 boxes, more than a float can number

/// Index of the lowest bit that is set; there must be one.
TAPE_HD inline int lowest_bit(std::uint64_t bits) {
#ifdef __CUDA_ARCH__
  return __ffsll(static_cast<long long>(bits)) - 1;
#else
  return std::countr_zero(bits);
#endif
}

struct TreeView {
  Span<const LanesOf8> nodes;
  Span<const int> id;     ///< [8 nodes of level 0] of the box at each place
  int first[kMaxLevels];  ///< where each level begins in `nodes`
  int levels;
  /// Calls f(id) for every box that meets the query, in Morton order.
  template <class F>
  TAPE_HD void visit(const Lanes& query, F&& f) const {
    if (levels == 0) return;
    int level = levels - 1, at = 0;  // node `at` of the level
    std::uint64_t open = 0;          // children yet to see: byte k for the one node of level k that leads here
    while (true) {
      unsigned met = nodes[first[level] + at].met(query);
      if (level > 0) {
        open |= std::uint64_t{met} << (8 * level);
      } else {
        for (; met != 0; met &= met - 1) f(id[8 * at + lowest_bit(met)]);
      }
      if (open == 0) return;
      const int next = lowest_bit(open), up = next / 8;
      open &= open - 1;
      at = 8 * (at >> (3 * (up - level))) + next % 8;
      level = up - 1;
    }
  }
};

namespace detail {
struct BoxJoin {
  TAPE_HD Lanes operator()(const Lanes& a, const Lanes& b) const { return merged(a, b); }
};
struct LoadLanes {
  Span<const Lanes> boxes;
  TAPE_HD Lanes operator()(int i) const { return boxes[i]; }
};
TAPE_HD inline std::uint64_t spread_bits(std::uint32_t v) {  // bit k of the low 16 goes to bit 3 k
  std::uint64_t x = v & 0xffffu;
  x = (x | x << 16) & 0x0000ff0000ffull;
  x = (x | x << 8) & 0x00f00f00f00full;
  x = (x | x << 4) & 0x0c30c30c30c3ull;
  x = (x | x << 2) & 0x249249249249ull;
  return x;
}
struct MortonKeys {
  Span<const Lanes> boxes;
  Lanes all;
  Span<std::uint64_t> key;
  Span<int> id;
  TAPE_HD void operator()(int i) const {
    const float extent = std::max(-all.m[3] - all.m[0], std::max(-all.m[4] - all.m[1], -all.m[5] - all.m[2]));
    const float scale = extent > 0 ? 65535.0f / extent : 0.0f;
    std::uint64_t code = 0;
    for (int k = 0; k < 3; ++k) {
      const float centre = 0.5f * (boxes[i].m[k] - boxes[i].m[3 + k]);
      code |= spread_bits(static_cast<std::uint32_t>(std::max(0.0f, (centre - all.m[k]) * scale))) << k;
    }
    key[i] = code;
    id[i] = i;
  }
};
struct FillLeaves {
  Span<const Lanes> boxes;
  Span<const int> ids;    ///< [n], or empty
  Span<const int> order;  ///< [n] box of each place in Morton order
  Span<LanesOf8> nodes;
  Span<int> id;  ///< [8 nodes] places beyond n stay empty
  TAPE_HD void operator()(int node) const {
    for (int k = 0; k < 8; ++k) {
      const int place = 8 * node + k;
      const bool used = place < order.size;
      id[place] = !used ? -1 : ids.size > 0 ? ids[order[place]] : order[place];
      nodes[node].set(k, used ? boxes[order[place]] : empty_box());
    }
  }
};
struct FillLevel {
  Span<const LanesOf8> below;
  Span<LanesOf8> nodes;
  TAPE_HD void operator()(int node) const {
    for (int k = 0; k < 8; ++k) nodes[node].set(k, 8 * node + k < below.size ? below[8 * node + k].all() : empty_box());
  }
};
}  // namespace detail

class BoxTree {
 public:
  /// @param ids  [boxes] what visit() calls each; empty: its number
  void build(Span<const Lanes> boxes, Span<const int> ids = {}) {
    const int n = boxes.size;
    key_.resize(n), order_.resize(n);
    view_ = {};
    if (n == 0) return;
    int size[kMaxLevels], total = 0;
    for (int count = n; view_.levels == 0 || count > 1; ++view_.levels) {
      count = (count + 7) / 8;
      TAPE_CHECK(view_.levels < kMaxLevels);
      size[view_.levels] = count, view_.first[view_.levels] = total;
      total += count;
    }
    nodes_.resize(total), id_.resize(8 * size[0]);
    view_.nodes = nodes_.span(), view_.id = id_.span();
    const Lanes all = reduce(n, empty_box(), detail::LoadLanes{boxes}, detail::BoxJoin{});
    parallel_for(n, detail::MortonKeys{boxes, all, key_.span(), order_.span()});
    sort_by_key(key_, order_);
    parallel_for(size[0], detail::FillLeaves{boxes, ids, order_.span(), level(0, size), id_.span()});
    for (int l = 1; l < view_.levels; ++l) parallel_for(size[l], detail::FillLevel{level(l - 1, size), level(l, size)});
  }
  TreeView view() const { return view_; }

 private:
  Span<LanesOf8> level(int l, const int* size) { return {nodes_.span().data + view_.first[l], size[l]}; }

  TreeView view_{};
  Buffer<LanesOf8> nodes_;
  Buffer<int> id_, order_;
  Buffer<std::uint64_t> key_;
};
}  // namespace tape::TAPE_SIDE
