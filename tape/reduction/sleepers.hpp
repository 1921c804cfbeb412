#pragma once
#include <vector>

#include "tape/bodies/assembly.hpp"
#include "tape/effects/effects.hpp"

namespace tape {
/// Tape that bodies carry because it lies still on them. States share it.
struct Sleepers {
  std::vector<int> body;    ///< [strip vertices] that carries it; -1: it is awake
  std::vector<Vec3> local;  ///< [strip vertices] m, of those that sleep, in frame B of their bodies
  EffectMemory asleep;      ///< of pairs all of whose vertices one of these bodies carries
};
/// Where everything was when tape was last looked at, and which body sees it move.
struct Glance {
  std::vector<Vec3> x;     ///< [strip vertices] m
  std::vector<Pose> body;  ///< [bodies] X_WB
  std::vector<int> frame;  ///< [strip vertices] the body that a vertex adheres to, or that the nearest along the strip does; -1: none
};
}  // namespace tape
