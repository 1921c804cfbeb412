#pragma once
#include <optional>

#include "tape/step/world.hpp"

namespace cosim {
/// Share [1] of a strip's area at rest that adheres: a vertex stands for a third of the triangles around it, and adheres where one of the
/// pairs that name it has more than half of its engagement left. What a cluster remembers does not count.
/// @param other  object of World::surface that it must adhere to; none: any
double attached_share(const tape::World& world, const tape::State& state, std::size_t strip, std::optional<std::size_t> other);

/// Length [m] along a line over which a strip adheres to both of two objects. A side is covered where edges between two vertices that
/// adhere to it run along the line.
/// @param along  unit vector in the world
double covered_seam(const tape::World& world, const tape::State& state, std::size_t strip, std::size_t first, std::size_t second,
                    const tape::Vec3& along);

/// Turns [1] that what adheres of a strip makes about an axis: the change of the angle along the strip, mean over its width, over triangles
/// whose vertices all adhere. Turns one way and back again cancel each other. What lies on its roll does not count.
/// @param wound  [m] of the strip, from its root on, on the roll  @param point, axis  [m], unit vector
double attached_turns(const tape::World& world, const tape::State& state, std::size_t strip, double wound, const tape::Vec3& point,
                      const tape::Vec3& axis);

/// Parts of a strip's mesh that share no vertex.
int pieces(const tape::World& world, std::size_t strip);
}  // namespace cosim
