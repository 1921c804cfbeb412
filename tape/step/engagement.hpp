#pragma once
#include <vector>

#include "tape/step/world.hpp"

namespace tape {
/// How much adhesion is left at each vertex of the strips [strip vertices], in [0, 1]: the most of all pairs that name it. Of a pair: its
/// beta; 1 for a bond; of area the stiffness that is left of it. 0 where nothing adheres.
std::vector<Real> vertex_engagement(const World& world, const State& state);
}  // namespace tape
