#pragma once
#include <memory>
#include <set>
#include <vector>

#include "tape/bodies/assembly.hpp"
#include "tape/effects/effects.hpp"
#include "tape/reduction/rest.hpp"
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
  std::shared_ptr<const Rest> rest;       ///< on the hub; null: it is awake there
  /// of pairs between members, and where it rests of members with the hub
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

/// Vertices of what is remembered, each as often as it occurs.
/// @param samples  to the side of a triangle, of cohesive zones
std::vector<int> vertices_of(const Assembly& assembly, int samples, EffectMemory memory);

/// Brings to `asleep` what of the pairs in it and in `awake` is among vertices that move as one, and to `awake` the rest; both sorted.
/// @param as_one  [nv] vertices with the same number move as one; -1: with no other
void sort_pairs(const Assembly& assembly, const std::vector<int>& as_one, int samples, EffectMemory& awake, EffectMemory& asleep);
}  // namespace tape
