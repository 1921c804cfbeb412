#include "tape/model/triangle_mesh.hpp"

#include <array>
#include <map>

namespace tape {
TriangleMesh merge_vertices(const TriangleMesh& mesh) {
  TriangleMesh merged;
  std::map<std::array<Real, 3>, int> index;
  std::vector<int> renamed(mesh.vertices.size(), -1);
  for (const Index3& t : mesh.triangles) {
    Index3 named;
    for (int k = 0; k < 3; ++k) {
      int& name = renamed[t[k]];
      if (name < 0) {
        const Vec3 v = mesh.vertices[t[k]] + Vec3::Zero();  // -0 is 0
        const auto [it, added] = index.try_emplace({v.x(), v.y(), v.z()}, static_cast<int>(merged.vertices.size()));
        if (added) merged.vertices.push_back(v);
        name = it->second;
      }
      named[k] = name;
    }
    merged.triangles.push_back(named);
  }
  return merged;
}
}  // namespace tape
