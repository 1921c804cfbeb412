#include "tape/step/settle.hpp"

#include <algorithm>

namespace tape {
namespace {
/// Stops all that moves. @return [m/s] the largest speed
Real halt(State& state) {
  Real fastest = 0;
  for (Vec3& v : state.v) {
    fastest = std::max(fastest, v.norm());
    v.setZero();
  }
  for (BodyState& body : state.bodies) {
    fastest = std::max(fastest, body.velocity.norm());
    body.velocity.setZero();
    body.angular_momentum.setZero();
  }
  return fastest;
}
}  // namespace

SettleReport settle(Stepper& stepper, State& state, const SettleParams& params) {
  SettleReport report;
  const int step = state.step;
  const Real time = state.time;
  halt(state);
  while (report.steps < params.max_steps) {
    const StepReport made = stepper.step(state);
    report.failure = made.failure;
    if (!made.ok) break;
    ++report.steps;
    report.speed = halt(state);
    if (report.speed <= params.speed) break;
    report.stopped = params.go_on && !params.go_on(report.steps, report.speed);
    if (report.stopped) break;
  }
  if (report.failure.empty() && !report.stopped && report.speed > params.speed)
    report.failure = "still moves at " + to_text(report.speed) + " m/s after " + std::to_string(report.steps) + " steps";
  state.step = step;
  state.time = time;
  return report;
}
}  // namespace tape
