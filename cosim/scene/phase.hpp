#pragma once
#include <string>
#include <vector>

#include "tape/model/moment.hpp"

namespace cosim {
/// A part of a script that has a name: it goes from its start until the next one begins.
struct Phase {
  std::string name;
  tape::Moment start;
};
/// The phase of a step: the last one that has begun when the step starts.
/// @param start   [s] of the step
/// @param events  [s] when each has happened (Moment::at)
/// @param dt      [s] of a step, to tell round-off from time
/// @return its index; -1: none has begun
int phase_at(const std::vector<Phase>& phases, double start, const std::vector<double>& events, double dt);
}  // namespace cosim
