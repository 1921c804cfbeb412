#pragma once
#include <cstdint>
#include <vector>

#include "tape/solver/block_matrix.hpp"

/// Host helpers of BlockMatrix, shared by both sides.
namespace tape {
std::uint64_t next_pattern_id();  ///< 1, 2, ...: a new one each time
/// @param fixed, contact  ascending keys of the two groups
HostBlocks merge_patterns(int n, const std::vector<std::uint64_t>& fixed, const std::vector<std::uint64_t>& contact);
/// host.values = the sum of the two groups' blocks
void sum_groups(Span<const Mat3> fixed, Span<const Mat3> contact, HostBlocks& host);
}  // namespace tape
