#pragma once
#include <algorithm>
#include <cmath>
#include <vector>

#include "tape/core/types.hpp"

namespace tape {
/// Error of conjugate gradients in the energy norm, from the scalars of the iteration.
/// Step j lowers the squared error by exactly d_j = alpha_j r_j' z_j [Hestenes 1952, th. 6:1; Strakos 2002], so with x_0 = 0
///   ||x - x_k||_A^2 = d_k + d_{k+1} + ...   and   ||x||_A^2 = d_0 + d_1 + ...
/// The sum of the last w = 1 + k/4 steps is therefore a lower bound of the squared error w steps ago. It stands for the error now,
/// which is smaller; an iteration may stand still for a quarter of its length before it is believed.
class EnergyErrorEstimate {
 public:
  void add(Real decrease) { sums_.push_back(sums_.back() + decrease); }
  /// Estimate of ||x - x_k||_A / ||x||_A after k calls of add, >= 0.
  Real relative() const {
    const std::size_t k = sums_.size() - 1, window = std::min(k, 1 + k / 4);
    return sums_[k] > 0 ? std::sqrt((sums_[k] - sums_[k - window]) / sums_[k]) : 0;
  }

 private:
  std::vector<Real> sums_{0};  // [k] d_0 + ... + d_{k-1}
};
}  // namespace tape
