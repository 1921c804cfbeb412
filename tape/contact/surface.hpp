#pragma once
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "tape/bodies/vertex_owner.hpp"
#include "tape/contact/pair.hpp"

namespace tape {
/// A vertex as contact sees it. Constant for a run.
struct SurfaceVertex {
  Real xi;       ///< [m]   half-thickness of the surface here
  Real area;     ///< [m^2] a third of the incident triangles, at rest
  int object;    ///< strip or body it belongs to; index into SurfaceMesh::objects
  int material;  ///< index of the material
  bool rim;      ///< at an open edge of the surface
};
struct SurfaceEdge {
  int v[2];
  Real area;     ///< [m^2] a third of the incident triangles, at rest
  Real length2;  ///< [m^2] squared rest length
};
struct SurfaceTriangle {
  int v[3];
  Real area;       ///< [m^2] at rest
  Real mean_area;  ///< [m^2] of the triangles of its object, at rest
  Sharing sharing;
  bool open;  ///< its object has a rim
};

/// What carries the vertices of a surface, as long as no cluster loses a member.
struct SurfaceCarriage {
  std::vector<VertexOwner> owner;   ///< [nv]
  std::vector<int> follows;         ///< [objects] as SurfaceMesh::follows
  std::vector<Vec3> home;           ///< [nv] m, where members of clusters are in a frame of their cluster that never changes
  std::map<int, Vec3> clusters;     ///< bodies that are clusters: members follow them for good; [m] their centre of mass in that frame
  std::map<int, int> resting = {};  ///< bodies that rest on a cluster, whatever little they move: the two never form a pair
};

/// Objects that one articulation moves, and its own blocks of unknowns.
struct JointlyMoved {
  std::vector<int> objects;
  int first_block = 0, blocks = 0;
};

/// Contact surface of the world: strips and bodies alike. Two primitives never form a pair when they share a vertex, when
/// both are fixed, when one rigid body carries both, or when their objects are kept apart by somebody else.
struct SurfaceMesh {
  std::vector<SurfaceVertex> vertices;  ///< [nv]
  std::vector<VertexOwner> owner;       ///< [nv]
  std::vector<SurfaceEdge> edges;
  std::vector<SurfaceTriangle> triangles;
  std::vector<std::string> objects;  ///< names, for messages
  std::vector<int> follows;          ///< [objects] body that most of it moves and turns with, its own included; -1: none
  std::vector<JointlyMoved> together;
  std::vector<std::pair<int, int>> tied;  ///< objects that springs hold to each other
  std::vector<char> apart;                ///< [objects objects] 1: never a pair, symmetric; empty: all may be
  int materials = 1;
  std::vector<Real> kappa = {1e4};  ///< [materials materials] Pa, stiffness of the barrier, symmetric

  bool kept_apart(int object, int other) const {
    return !apart.empty() && apart[static_cast<std::size_t>(object) * objects.size() + static_cast<std::size_t>(other)] != 0;
  }
  /// Appends an object; its edges, areas and neighbours follow from its triangles.
  /// @param rest   [n] m
  /// @param added  its triangles, vertices counted from its first
  void add_object(const std::string& name, const std::vector<Vec3>& rest, const std::vector<VertexOwner>& owners,
                  const std::vector<Index3>& added, Real xi, int material, int follows_body = -1);
};
}  // namespace tape
