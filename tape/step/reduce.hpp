#pragma once
#include "tape/cutting/adhesion.hpp"
#include "tape/step/world.hpp"

namespace tape {
/// Forms the next cluster of a state at its start from what adheres, and the body that it is: velocities of its members become those of a
/// rigid motion with their momentum.
void form_cluster(const World& world, State& state);
/// What carries what in a state.
Carriage carry(const World& world, const State& state);
/// The same for contact: what is wound follows its cluster while that has members, else its hub.
SurfaceCarriage surface_carriage(const World& world, const State& state, const Carriage& carriage);
/// [strip vertices] what each is part of; tape that is neither reduced nor asleep is free.
enum class TapePart { free, collar, cluster, asleep };
std::vector<TapePart> tape_parts(const World& world, const State& state);
/// [strip vertices] m/s; members of clusters move as these do.
std::vector<Vec3> velocities(const World& world, const State& state);
/// Gives the clusters the numbers of the world after a cut. Motion of members is taken from their velocities in `state`; what the cut has
/// made is free tape, and what is nearer to that than the collar leaves its cluster.
/// @param before  the world before the cut
void cut_cluster(const World& before, const World& world, std::size_t strip, const CutInWorld& cut, State& state);
/// Lets tape go where it has passed the fronts of its clusters in a step. What leaves a cluster keeps its motion, and what adhered in it
/// wakes as it was; momentum and energy of motion stay to round-off.
/// @param carriage  of both states
/// @return whether a front has moved: then `carriage` holds no more
bool advance_fronts(const World& world, const Carriage& carriage, const State& before, State& after);

/// What holds cluster k where it rests.
Seat::Element seat_of(const World& world, const State& state, std::size_t k, const Rest& rest);
std::vector<Seat::Element> seats(const World& world, const State& state);
/// [1] how far cluster k is from where it rests on its hub, over its reach; infinite if a member that touched the hub has left.
/// @param carriage  of the state
Real off_its_rest(const World& world, const Carriage& carriage, const State& state, std::size_t k);
/// Whether cluster k has moved no farther than that [m] against its hub.
bool stays_on_hub(const World& world, const State& before, const State& after, std::size_t k, Real far);
/// Where cluster k might rest, with its reach by the gaps, but without its form; nothing where the hub is fixed or nothing adheres to it.
/// @param pairs  all that are near, in contact or not
std::optional<Rest> place_of_rest(const World& world, const State& state, std::size_t k, const std::vector<ContactPair>& pairs);
void put_to_rest(const World& world, std::size_t k, Rest rest, State& state);
/// What cluster k at rest remembers asleep.
struct RestingPairs {
  EffectMemory with_hub, of_members;
  std::vector<Vec3> x;  ///< [nv] m, positions of all vertices if the cluster stood where it came to rest
};
RestingPairs resting_pairs(const World& world, const Carriage& carriage, const State& state, std::size_t k);
/// Ends the rest of cluster k. @param of_members, with_hub  its resting pairs, as they are now
void wake(const World& world, const Carriage& carriage, std::size_t k, EffectMemory of_members, EffectMemory with_hub, State& state);
}  // namespace tape
