#pragma once
#include "cosim/exchange/exchange.hpp"
#include "cosim/scene/claim.hpp"
#include "tape/step/stepper.hpp"

namespace cosim {
/// The value of what a claim is about, at the end of a step.
/// @param joints  needed where it is about one
double measure(const Claim& claim, const tape::World& world, const tape::State& state, const tape::StepReport& report,
               const JointPositions& joints = {});
/// Whether it is above or below the claim's level, as that says.
inline bool holds(const Claim& claim, double value) { return claim.above ? value > claim.level : value < claim.level; }
}  // namespace cosim
