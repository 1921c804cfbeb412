#pragma once
#include <vector>

#include "tape/contact/pair.hpp"
#include "tape/step/world.hpp"

namespace tape {
/// Whether how still tape lies must be looked at, after a step.
bool is_to_look_at_tape(const World& world, const State& after);
/// Lets tape sleep that has lain still on its body since the last look, and wakes what is near something that has moved there.
/// @param near  all pairs that are near, in contact or not
/// @return whether something has fallen asleep or woken: then another carriage holds
bool settle_tape(const World& world, const State& before, const std::vector<ContactPair>& near, State& after);
/// Whether a grip closes on tape that sleeps, in the step from here.
bool grip_wakes_tape(const World& world, const State& state);
/// Wakes all tape, and forgets how it lay.
void wake_tape(const World& world, State& state);
/// Strip vertices that sleep.
int sleeping(const State& state);
}  // namespace tape
