#pragma once
#include <vector>

#include "tape/bodies/vertex_fans.hpp"
#include "tape/contact/surface.hpp"
#include "tape/core/side.hpp"

namespace tape::TAPE_SIDE {
/// The fans of a surface's vertices, in the memory of this side.
class SurfaceFans {
 public:
  explicit SurfaceFans(const SurfaceMesh& mesh) {
    std::vector<int> first(mesh.vertices.size() + 1, 0);
    for (const SurfaceTriangle& t : mesh.triangles)
      for (int v : t.v) ++first[static_cast<std::size_t>(v) + 1];
    for (std::size_t v = 1; v < first.size(); ++v) first[v] += first[v - 1];
    std::vector<int> next = first;
    std::vector<Index2> corners(3 * mesh.triangles.size());
    for (const SurfaceTriangle& t : mesh.triangles)
      for (int k = 0; k < 3; ++k)
        corners[static_cast<std::size_t>(next[static_cast<std::size_t>(t.v[k])]++)] = Index2(t.v[(k + 1) % 3], t.v[(k + 2) % 3]);
    first_.upload(first);
    corners_.upload(corners);
  }
  VertexFans view() const { return {first_.span(), corners_.span()}; }

 private:
  Buffer<int> first_;
  Buffer<Index2> corners_;
};
}  // namespace tape::TAPE_SIDE
