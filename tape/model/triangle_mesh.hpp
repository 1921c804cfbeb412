#pragma once
#include <vector>

#include "tape/core/types.hpp"

namespace tape {
struct TriangleMesh {
  std::vector<Vec3> vertices;     ///< [m]
  std::vector<Index3> triangles;  ///< outward normals for closed surfaces
};

/// The mesh with equal vertices made one, in the order of their first use; vertices that no triangle uses go.
/// Assumes finite vertices and indices in range.
TriangleMesh merge_vertices(const TriangleMesh& mesh);
}  // namespace tape
