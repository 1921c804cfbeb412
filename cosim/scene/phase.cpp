#include "cosim/scene/phase.hpp"

namespace cosim {
int phase_at(const std::vector<Phase>& phases, double start, const std::vector<double>& events, double dt) {
  const double round_off = 1e-6 * dt;
  auto last = static_cast<int>(phases.size()) - 1;
  while (last >= 0 && !(phases[static_cast<std::size_t>(last)].start.at(events) <= start + round_off)) --last;
  return last;
}
}  // namespace cosim
