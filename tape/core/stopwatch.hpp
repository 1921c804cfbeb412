#pragma once
#include <chrono>

#include "tape/core/types.hpp"

namespace tape {
/// Adds the time it lives [ms] to a total.
class Stopwatch {
 public:
  explicit Stopwatch(Real& total_ms) : total_(total_ms) {}
  ~Stopwatch() { total_ += std::chrono::duration<Real, std::milli>(Clock::now() - start_).count(); }
  Stopwatch(const Stopwatch&) = delete;
  Stopwatch& operator=(const Stopwatch&) = delete;

 private:
  using Clock = std::chrono::steady_clock;
  Real& total_;
  Clock::time_point start_ = Clock::now();
};
}  // namespace tape
