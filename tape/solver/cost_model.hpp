#pragma once
#include "tape/solver/block_matrix.hpp"
#include "tape/solver/linear_params.hpp"

namespace tape {
/// Predicted cost of one solve with each solver [s], from sizes alone (README: cost model).
struct LinearCosts {
  Real cholesky = 0, pcg_jacobi = 0, pcg_strip = 0, pcg_two_level = 0;
};
LinearCosts linear_costs(const HostBlocks& pattern, const SystemLayout& layout);

/// The cheapest solver by linear_costs among those that the side offers; a function of pattern and layout alone.
/// @param strip_available  whether the side offers pcg_strip
LinearKind choose(const HostBlocks& pattern, const SystemLayout& layout, bool strip_available);
}  // namespace tape
