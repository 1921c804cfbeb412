#pragma once
#include <vector>

#include "cosim/scene/event.hpp"
#include "tape/step/stepper.hpp"

namespace cosim {
/// The value that an event looks at, at the end of a step.
double value_of(const Event& event, const tape::World& world, const tape::State& state, const tape::StepReport& report);

/// Notes in the state which events have happened by the end of a step: when their value is there, or when their time is over.
void note_events(const std::vector<Event>& events, const tape::World& world, const tape::StepReport& report, tape::State& state);
}  // namespace cosim
