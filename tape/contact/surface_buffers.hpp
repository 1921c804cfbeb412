#pragma once
#include <algorithm>
#include <span>
#include <vector>

#include "tape/contact/kernels.inl"

namespace tape::TAPE_SIDE::detail {
/// Which body carries each whole primitive; kFixed or kFree if none does. Objects of free vertices alone have a leader. On the host.
struct Carriers {
  std::vector<int> vertex, edge, triangle, leader;
  explicit Carriers(const SurfaceMesh& mesh) {
    for (const VertexOwner& o : mesh.owner) vertex.push_back(o.block < 0 ? kFixed : o.body < 0 ? kFree : o.body);
    for (const SurfaceEdge& e : mesh.edges) edge.push_back(common(e.v));
    for (const SurfaceTriangle& t : mesh.triangles) triangle.push_back(common(t.v));
    leader.assign(mesh.objects.size(), -1);
    for (std::size_t v = mesh.vertices.size(); v-- > 0;) leader[static_cast<std::size_t>(mesh.vertices[v].object)] = static_cast<int>(v);
    for (std::size_t v = 0; v < mesh.vertices.size(); ++v)
      if (vertex[v] != kFree) leader[static_cast<std::size_t>(mesh.vertices[v].object)] = -1;
  }
  int common(std::span<const int> v) const {
    const int c = vertex[static_cast<std::size_t>(v[0])];
    return std::ranges::all_of(v, [&](int w) { return vertex[static_cast<std::size_t>(w)] == c; }) ? c : kFree;
  }
};

/// The surface in the memory of this side.
struct SurfaceBuffers {
  SurfaceBuffers(const SurfaceMesh& mesh, Real dhat_, Real guard_)
      : vertices(mesh.vertices), edges(mesh.edges), triangles(mesh.triangles), materials(mesh.materials), dhat(dhat_), guard(guard_) {
    const Carriers carriers(mesh);
    vertex_carrier.upload(carriers.vertex), edge_carrier.upload(carriers.edge), triangle_carrier.upload(carriers.triangle);
    leader.upload(carriers.leader);
  }
  SurfaceView view() const {
    return {vertices.span(),
            edges.span(),
            triangles.span(),
            vertex_carrier.span(),
            edge_carrier.span(),
            triangle_carrier.span(),
            leader.span(),
            materials,
            dhat,
            guard};
  }
  Buffer<SurfaceVertex> vertices;
  Buffer<SurfaceEdge> edges;
  Buffer<SurfaceTriangle> triangles;
  Buffer<int> vertex_carrier, edge_carrier, triangle_carrier, leader;
  int materials;
  Real dhat, guard;
};
}  // namespace tape::TAPE_SIDE::detail
