#pragma once
#include <string>
#include <utility>
#include <vector>

#include "tape/step/world.hpp"

namespace cosim {
using namespace tape;
/// A roll as it is in a state, key with unit and value. Its wound part ends where the tape last adheres to itself or to the hub:
/// turns, wound_length_m, outer_radius_m (half a pitch beyond the mean of its last turn) of that part; roll_mass_kg and roll_inertia_kg_m2,
/// about the hub's axis, of hub and wound part.
std::vector<std::pair<std::string, Real>> roll_figures(const World& world, const State& state, std::size_t strip);
}  // namespace cosim
