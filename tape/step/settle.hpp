#pragma once
#include <functional>
#include <string>

#include "tape/step/stepper.hpp"

namespace tape {
struct SettleParams {
  Real speed = 1e-7;    ///< [m/s] nothing may be faster in the last step; steps of 1 s move by 0.1 um then
  int max_steps = 100;  ///< after which it counts as failed
  /// Called after each step with their number and the largest speed [m/s]; false: stop. May be empty.
  std::function<bool(int, Real)> go_on = {};
};
struct SettleReport {
  int steps = 0;
  Real speed = 0;         ///< [m/s] of the fastest vertex or body in the last step
  std::string failure{};  ///< why it did not come to rest; empty if it did
  bool stopped = false;   ///< by go_on
};
/// Brings a state to rest: steps that forget all velocities, so that what adheres and what is elastic find their balance without swinging.
/// The state keeps its step and time.
SettleReport settle(Stepper& stepper, State& state, const SettleParams& params);
}  // namespace tape
