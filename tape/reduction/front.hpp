#pragma once
#include <vector>

#include "tape/reduction/cluster.hpp"

namespace tape {
/// What the front of a cluster sees after a step.
struct FrontView {
  const Assembly& assembly;
  const StripPart& strip;
  const BodyPart& core;
  const std::vector<Vec3>& x;  ///< [nv] m
  Pose cluster, hub;           ///< X_WB; the hub's axis is its z
};
/// Marks what bonds of the wound roll, of the strip with itself or with its core, have let go: those of `before` that `after` lacks,
/// between tape of which no side is free.
void mark_released(const FrontView& view, const std::vector<Bonds::Memory>& before, const std::vector<Bonds::Memory>& after,
                   Cluster& cluster);
/// Collar vertices that become free: by the gate, and where bonds hold the roll together only if they were released and no bond holds them.
/// @param next   those one edge from the free tape
/// @param delta  [m] of the gate
/// @param bonds  what holds now; null: cohesion holds the roll, and the gate alone decides
std::vector<int> pass_front(const FrontView& view, const Cluster& cluster, const std::vector<int>& next, Gate gate, Real delta,
                            const std::vector<Bonds::Memory>* bonds);
}  // namespace tape
