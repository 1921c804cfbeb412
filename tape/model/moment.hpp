#pragma once
#include <limits>
#include <vector>

#include "tape/core/types.hpp"

namespace tape {
/// A time [s] that counts from the start of the run, or from an event that nobody can know the time of before it happens.
struct Moment {
  Real time = 0;
  int after = -1;  ///< index of an event; -1: the start

  Moment(Real seconds = 0, int event = -1) : time(seconds), after(event) {}  // NOLINT(google-explicit-constructor): a time is one
  bool operator==(const Moment&) const = default;
  /// @param events  [s] when each has happened, infinite if it has not; those beyond its end have not
  Real at(const std::vector<Real>& events) const {
    if (after < 0) return time;
    const auto k = static_cast<std::size_t>(after);
    return time + (k < events.size() ? events[k] : std::numeric_limits<Real>::infinity());
  }
};
}  // namespace tape
