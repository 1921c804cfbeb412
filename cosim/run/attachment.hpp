#pragma once
#include <optional>

#include "tape/step/world.hpp"

namespace cosim {
/// Share [1] of a strip's area at rest that adheres: a vertex stands for a third of the triangles around it, and adheres where one of the
/// pairs that name it has more than half of its engagement left. What sleeps in a cluster does not count.
/// @param other  object of World::surface that it must adhere to; none: any
double attached_share(const tape::World& world, const tape::State& state, std::size_t strip, std::optional<std::size_t> other);

/// Length [m] along a line over which a strip adheres to both of two objects. A side is covered where edges between two vertices that
/// adhere to it run along the line.
/// @param along  unit vector in the world
double covered_seam(const tape::World& world, const tape::State& state, std::size_t strip, std::size_t first, std::size_t second,
                    const tape::Vec3& along);

/// Parts of a strip's mesh that share no vertex.
int pieces(const tape::World& world, std::size_t strip);
}  // namespace cosim
