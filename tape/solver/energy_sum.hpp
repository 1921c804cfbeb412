#pragma once
#include "tape/core/types.hpp"

namespace tape {
/// A sum of energies and of their magnitudes: the second tells what round-off the first may carry.
struct EnergySum {
  Real sum = 0, scale = 0;  ///< [J]
};
TAPE_HD inline EnergySum operator+(const EnergySum& a, const EnergySum& b) { return {a.sum + b.sum, a.scale + b.scale}; }
}  // namespace tape
