#pragma once
#include <bit>
#include <cstdint>

#include "tape/contact/box.hpp"
#include "tape/core/side.hpp"

/// Bounding volume hierarchy: an implicit complete binary tree over boxes in Morton order. Node 1 is the root, node k has the
/// children 2k and 2k + 1, the leaves are nodes [leaves, 2 leaves). Nothing in it depends on the number of threads.
namespace tape::TAPE_SIDE {
struct TreeView {
  Span<const Lanes> nodes;  ///< [2 leaves]; node 0 is not used
  Span<const int> id;       ///< [leaves] box at each leaf
  /// Calls f(id) for every box that meets the query, in Morton order.
  template <class F>
  TAPE_HD void visit(const Lanes& query, F&& f) const {
    const unsigned leaves = static_cast<unsigned>(id.size);
    if (leaves == 0) return;
    unsigned k = 1;
    do {
      const bool hit = meets(nodes[static_cast<int>(k)], query);
      if (hit && k < leaves) {
        k *= 2;
        continue;
      }
      if (hit) f(id[static_cast<int>(k - leaves)]);
      ++k;  // the next node in depth-first order that is not below this one
      k >>= std::countr_zero(k);
    } while (k != 1);
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
    const float extent = std::fmax(-all.m[3] - all.m[0], std::fmax(-all.m[4] - all.m[1], -all.m[5] - all.m[2]));
    const float scale = extent > 0 ? 65535.0f / extent : 0.0f;
    std::uint64_t code = 0;
    for (int k = 0; k < 3; ++k) {
      const float centre = 0.5f * (boxes[i].m[k] - boxes[i].m[3 + k]);
      code |= spread_bits(static_cast<std::uint32_t>(std::fmax(0.0f, (centre - all.m[k]) * scale))) << k;
    }
    key[i] = code;
    id[i] = i;
  }
};
struct FillLeaves {
  Span<const Lanes> boxes;
  Span<const int> order;  ///< [n] box of each place in Morton order
  Span<Lanes> nodes;
  Span<int> id;  ///< [leaves] places beyond n stay empty
  TAPE_HD void operator()(int i) const {
    const bool used = i < order.size;
    id[i] = used ? order[i] : -1;
    nodes[id.size + i] = used ? boxes[order[i]] : empty_box();
  }
};
struct MergeLevel {
  Span<Lanes> nodes;
  int first;
  TAPE_HD void operator()(int i) const { nodes[first + i] = merged(nodes[2 * (first + i)], nodes[2 * (first + i) + 1]); }
};
}  // namespace detail

class BoxTree {
 public:
  void build(Span<const Lanes> boxes) {
    const int n = boxes.size;
    key_.resize(n), order_.resize(n);
    const int leaves = n == 0 ? 0 : static_cast<int>(std::bit_ceil(static_cast<unsigned>(n)));
    id_.resize(leaves), nodes_.resize(2 * leaves);
    if (n == 0) return;
    const Lanes all = reduce(n, empty_box(), detail::LoadLanes{boxes}, detail::BoxJoin{});
    parallel_for(n, detail::MortonKeys{boxes, all, key_.span(), order_.span()});
    sort_by_key(key_, order_);
    parallel_for(leaves, detail::FillLeaves{boxes, order_.span(), nodes_.span(), id_.span()});
    for (int first = leaves / 2; first > 0; first /= 2) parallel_for(first, detail::MergeLevel{nodes_.span(), first});
  }
  TreeView view() const { return {nodes_.span(), id_.span()}; }

 private:
  Buffer<Lanes> nodes_;
  Buffer<int> id_, order_;
  Buffer<std::uint64_t> key_;
};
}  // namespace tape::TAPE_SIDE
