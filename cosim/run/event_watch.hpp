#pragma once
#include <vector>

#include "cosim/exchange/exchange.hpp"
#include "cosim/scene/event.hpp"
#include "tape/step/stepper.hpp"

namespace cosim {
/// Notes in the state which events have happened by the end of a step: when their claim is true, or when their time is over.
/// @param joints  needed where one of them is about a joint
void note_events(const std::vector<Event>& events, const tape::World& world, const tape::StepReport& report, const JointPositions& joints,
                 tape::State& state);
}  // namespace cosim
