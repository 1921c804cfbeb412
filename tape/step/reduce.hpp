#pragma once
#include "tape/step/world.hpp"

namespace tape {
/// Forms the next cluster of a state at its start from what adheres, and the body that it is: velocities of its members become those of a
/// rigid motion with their momentum.
void form_cluster(const World& world, State& state);
/// What carries what in a state.
Carriage carry(const World& world, const State& state);
/// The same for contact: what is wound follows its cluster while that has members, else its hub.
SurfaceCarriage surface_carriage(const World& world, const State& state, const Carriage& carriage);
/// [strip vertices] what each is part of; tape that is not reduced is free.
enum class TapePart { free, collar, cluster };
std::vector<TapePart> tape_parts(const World& world, const State& state);
/// Lets tape go where it has passed the fronts of its clusters in a step. What leaves a cluster keeps its motion, and what adhered in it
/// wakes as it was; momentum and energy of motion stay to round-off.
/// @param carriage  of both states
/// @return whether a front has moved: then `carriage` holds no more
bool advance_fronts(const World& world, const Carriage& carriage, const State& before, State& after);
}  // namespace tape
