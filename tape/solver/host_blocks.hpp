#pragma once
#include <cstdint>
#include <vector>

#include "tape/solver/block_matrix.hpp"

/// Host helpers of BlockMatrix, shared by both sides.
namespace tape {
std::uint64_t next_pattern_id();  ///< 1, 2, ...: a new one each time
/// Lists the blocks of both groups in a host whose memory is used again: it is touched in every Newton iteration with new contacts.
/// @param fixed, contact  ascending keys of the two groups
void merge_patterns(int n, const std::vector<std::uint64_t>& fixed, const std::vector<std::uint64_t>& contact, HostBlocks& host);
/// host.values = the sum of the two groups' blocks
void sum_groups(Span<const Mat3> fixed, Span<const Mat3> contact, HostBlocks& host);
/// Where each row of blocks [first, end) ends in the fixed group, counted from `first`; nowhere less than the row before.
std::vector<int> fixed_profile(const HostBlocks& a, int first, int end);
}  // namespace tape
