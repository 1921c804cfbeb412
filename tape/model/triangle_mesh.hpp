#pragma once
#include <vector>

#include "tape/core/types.hpp"

namespace tape {
struct TriangleMesh {
  std::vector<Vec3> vertices;     ///< [m]
  std::vector<Index3> triangles;  ///< outward normals for closed surfaces
};
}  // namespace tape
