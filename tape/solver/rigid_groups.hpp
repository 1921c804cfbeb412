#pragma once
#include <vector>

#include "tape/solver/linear_params.hpp"

namespace tape {
/// Rows of a strip that a group of the coarse space takes together (README: measured for 4, 5 and 6).
inline constexpr int kRowsPerGroup = 4;

/// Consecutive blocks of unknowns that share the 6 modes of a rigid motion.
struct RigidGroup {
  int first = 0;
  int blocks = 0;
  int body = 0;  ///< 1: translation and rotation of a rigid body, its unknowns are the modes; 0: points of a strip
};
/// Groups of kRowsPerGroup rows of each strip, the last of a strip half of that to half more; then the bodies. First blocks ascend.
std::vector<RigidGroup> rigid_groups(const SystemLayout& layout);
/// @return [n] group of each block, -1 where no group has it
std::vector<int> group_of_blocks(const std::vector<RigidGroup>& groups, int n);
}  // namespace tape
