#pragma once
#include <vector>

#include "tape/reduction/cluster.hpp"
#include "tape/reduction/sleepers.hpp"

namespace tape {
/// What carries each vertex and what has mass, as long as no cluster loses a member and no tape falls asleep or wakes. Without any of these
/// it is as the assembly says.
struct Carriage {
  struct FreeStrip {
    int block = 0, blocks = 0;  ///< first block of its vertices that nothing carries, and how many; they are consecutive
  };
  std::vector<VertexOwner> owner;      ///< [nv]
  std::vector<Vec3> local;             ///< [nv] m, in frame B; vertices of bodies, members of clusters and tape that sleeps
  std::vector<Real> mass;              ///< [nv] kg: strip vertices but for members of clusters, and whole bodies at their centres
  std::vector<BodyMass> body_mass;     ///< [bodies]
  std::vector<FreeStrip> strips;       ///< [strips]
  std::vector<std::vector<int>> next;  ///< [clusters] collar vertices one edge from the free tape, counted from the strip's first
  int blocks = 0;
};
/// Vertices that are one edge from the free tape and no members, counted from the strip's first.
std::vector<int> next_to_free(const Cluster& cluster, const std::vector<bool>& member);
/// @param clusters  in the order of the bodies that they are  @param sleepers  null: none
Carriage carry(const Assembly& assembly, const std::vector<Cluster>& clusters, const Sleepers* sleepers, int collar);
}  // namespace tape
