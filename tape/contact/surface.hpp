#pragma once
#include <string>
#include <vector>

#include "tape/bodies/path.hpp"
#include "tape/core/types.hpp"

namespace tape {
/// A vertex as contact sees it. Constant for a run.
struct SurfaceVertex {
  Real xi;       ///< [m]   half-thickness of the surface here
  Real area;     ///< [m^2] a third of the incident triangles, at rest
  int object;    ///< strip or body it belongs to; index into SurfaceMesh::objects
  int material;  ///< index of the material
};
struct SurfaceEdge {
  int v[2];
  Real area;     ///< [m^2] a third of the incident triangles, at rest
  Real length2;  ///< [m^2] squared rest length
};
struct SurfaceTriangle {
  int v[3];
  Real area;  ///< [m^2] at rest
};

/// Contact surface of the world: strips and bodies alike. Two primitives never form a pair when they share a vertex, when
/// both are fixed, or when one rigid body carries both.
struct SurfaceMesh {
  std::vector<SurfaceVertex> vertices;  ///< [nv]
  std::vector<VertexOwner> owner;       ///< [nv]
  std::vector<SurfaceEdge> edges;
  std::vector<SurfaceTriangle> triangles;
  std::vector<std::string> objects;  ///< names, for messages
  int materials = 1;
};
}  // namespace tape
