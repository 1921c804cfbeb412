#include "cosim/run/event_watch.hpp"

#include <cmath>

#include "cosim/run/measure.hpp"

namespace cosim {
void note_events(const std::vector<Event>& events, const tape::World& world, const tape::StepReport& report, const JointPositions& joints,
                 tape::State& state) {
  const double round_off = 1e-6 * world.setup.scene.time.dt;
  for (std::size_t k = 0; k < events.size(); ++k) {
    const Event& event = events[k];
    const double start = event.start.at(state.events);
    if (std::isfinite(state.events[k]) || !(state.time >= start - round_off)) continue;
    if (holds(event.claim, measure(event.claim, world, state, report, joints)) || state.time >= start + event.timeout - round_off)
      state.events[k] = state.time;
  }
}
}  // namespace cosim
