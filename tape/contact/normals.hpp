#pragma once
#include "tape/contact/surface.hpp"
#include "tape/core/side.hpp"

namespace tape::TAPE_SIDE {
namespace detail {
struct MeanNormal {
  Span<const SurfaceTriangle> triangles;
  Span<const int> first, around;  ///< triangles around vertex v: around[first[v] ... first[v + 1])
  Span<const Vec3> x;
  Span<Vec3> normal;
  TAPE_HD void operator()(int v) const {
    Vec3 sum = Vec3::Zero();
    for (int k = first[v]; k < first[v + 1]; ++k) {
      const int(&t)[3] = triangles[around[k]].v;
      sum += (x[t[1]] - x[t[0]]).cross(x[t[2]] - x[t[0]]);
    }
    normal[v] = sum.normalized();
  }
};
}  // namespace detail

/// Mean normals of the triangles around each vertex, weighted by area.
class VertexNormals {
 public:
  explicit VertexNormals(const SurfaceMesh& mesh) : triangles_(mesh.triangles) {
    std::vector<int> first(mesh.vertices.size() + 1, 0), around(3 * mesh.triangles.size());
    for (const SurfaceTriangle& t : mesh.triangles)
      for (int v : t.v) ++first[static_cast<std::size_t>(v) + 1];
    for (std::size_t v = 1; v < first.size(); ++v) first[v] += first[v - 1];
    std::vector<int> next = first;
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
      for (int v : mesh.triangles[t].v) around[static_cast<std::size_t>(next[static_cast<std::size_t>(v)]++)] = static_cast<int>(t);
    first_.upload(first);
    around_.upload(around);
  }
  /// @param x  [nv] m  @return [nv], unit; zero where there is no area
  Span<const Vec3> at(Span<const Vec3> x) {
    normal_.resize(first_.size() - 1);
    parallel_for(normal_.size(), detail::MeanNormal{triangles_.span(), first_.span(), around_.span(), x, normal_.span()});
    return normal_.span();
  }

 private:
  Buffer<SurfaceTriangle> triangles_;
  Buffer<int> first_, around_;
  Buffer<Vec3> normal_;
};
}  // namespace tape::TAPE_SIDE
