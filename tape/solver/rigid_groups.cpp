#include "tape/solver/rigid_groups.hpp"

#include <algorithm>

#include "tape/core/error.hpp"

namespace tape {
std::vector<RigidGroup> rigid_groups(const SystemLayout& layout) {
  std::vector<RigidGroup> groups;
  for (const StripLayout& strip : layout.strips) {
    const int size = kRowsPerGroup * strip.blocks_per_row, count = std::max(1, (strip.blocks + size / 2) / size);
    for (int k = 0; k < count; ++k) groups.push_back({strip.first_block + k * size, k + 1 < count ? size : strip.blocks - k * size});
  }
  for (int b : layout.body_blocks) groups.push_back({b, 2, 1});
  std::ranges::sort(groups, {}, &RigidGroup::first);
  return groups;
}

std::vector<int> group_of_blocks(const std::vector<RigidGroup>& groups, int n) {
  std::vector<int> group(static_cast<std::size_t>(n), -1);
  for (std::size_t g = 0; g < groups.size(); ++g) {
    const RigidGroup& blocks = groups[g];
    TAPE_CHECK(blocks.first >= 0 && blocks.first + blocks.blocks <= n);
    std::fill_n(group.begin() + blocks.first, blocks.blocks, static_cast<int>(g));
  }
  return group;
}
}  // namespace tape
