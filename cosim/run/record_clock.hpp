#pragma once
#include <cmath>
#include <utility>

#include "tape/core/types.hpp"

namespace cosim {
using tape::Real;

/// Says when the next state is due at a rate: the first at or after each multiple of its period.
class RecordClock {
 public:
  /// @param rate  [1/s]  @param start  [s] of the run
  RecordClock(Real rate, Real start) : rate_(rate), ticks_(count(start)) {}
  bool due(Real time) {
    const Real now = count(time);
    return now > std::exchange(ticks_, now);
  }

 private:
  Real count(Real time) const { return std::floor(time * rate_ + 1e-6); }
  Real rate_, ticks_;
};
}  // namespace cosim
