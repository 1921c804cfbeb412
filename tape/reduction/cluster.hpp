#pragma once
#include <memory>
#include <set>
#include <vector>

#include "tape/bodies/assembly.hpp"
#include "tape/effects/effects.hpp"
#include "tape/reduction/strip_graph.hpp"

namespace tape {
/// The wound part of a roll, which moves as one rigid body and gives tape back at its front [the paper, III-C]. Vertices are counted from
/// the first of its strip. Without members it is a body of unit mass that nothing touches. States share what does not change in a step.
struct Cluster {
  /// [vertices] m, y: where each vertex was when the cluster formed, in the world of that moment
  std::shared_ptr<const std::vector<Vec3>> local = std::make_shared<const std::vector<Vec3>>();
  /// [vertices] edges to the free tape, at most the collar; 0: free
  std::shared_ptr<const std::vector<int>> distance = std::make_shared<const std::vector<int>>();
  std::set<int> released;                 ///< vertices that a bond of the wound roll has let go, and which are not free yet
  Vec3 centre = Vec3::Zero();             ///< [m] centre of mass of the members, a y
  BodyMass mass = {1, Mat3::Identity()};  ///< of the members, about the centre
  /// of pairs between members
  std::shared_ptr<const EffectMemory> asleep = std::make_shared<const EffectMemory>();
};

/// Triangles that are `collar` edges or more from the free tape all over are rigid; their vertices are the members.
std::vector<bool> members(const Assembly& assembly, const StripPart& strip, const Cluster& cluster, int collar);

/// Forms the cluster of a strip where it stands, from what adheres: tape behind the last place that does is free, and so is its end.
/// @param memory  of the roll alone
/// @param x       [nv] m
Cluster form_cluster(const Assembly& assembly, const StripPart& strip, const StripGraph& graph, const EffectMemory& memory,
                     const std::vector<Vec3>& x, int samples, int collar);

/// Centre and mass of the members.
void weigh(const Assembly& assembly, const StripPart& strip, const std::vector<bool>& member, Cluster& cluster);

/// Brings to `awake` what of the pairs in it and in `asleep` spans a vertex that is not carried by `body`, and to `asleep` the rest; both
/// sorted.
/// @param samples  to the side of a triangle, of cohesive zones
void sort_pairs(const Assembly& assembly, const std::vector<VertexOwner>& owner, int body, int samples, EffectMemory& awake,
                EffectMemory& asleep);
}  // namespace tape
