#pragma once
#include <algorithm>
#include <map>
#include <span>
#include <vector>

#include "tape/contact/kernels.inl"

namespace tape::TAPE_SIDE::detail {
/// Which body carries each whole primitive; kFixed or kFree if none does. On the host.
struct Carriers {
  std::vector<int> vertex, edge, triangle;
  explicit Carriers(const SurfaceMesh& mesh) {
    for (const VertexOwner& o : mesh.owner) vertex.push_back(o.block < 0 ? kFixed : o.body < 0 ? kFree : o.body);
    for (const SurfaceEdge& e : mesh.edges) edge.push_back(common(e.v));
    for (const SurfaceTriangle& t : mesh.triangles) triangle.push_back(common(t.v));
  }
  int common(std::span<const int> v) const {
    const int c = vertex[static_cast<std::size_t>(v[0])];
    return std::ranges::all_of(v, [&](int w) { return vertex[static_cast<std::size_t>(w)] == c; }) ? c : kFree;
  }
};

/// Which frame each vertex follows: objects that follow a body, its; any other object of free vertices alone, that of its first vertex;
/// the rest, the world's. On the host.
struct Frames {
  std::vector<int> vertex, lead = {-1};
  Frames(const SurfaceMesh& mesh, const Carriers& carriers) {
    std::vector<int> first(mesh.objects.size(), -1), of_object(mesh.objects.size(), kWorld);
    std::vector<bool> free(mesh.objects.size(), true);
    std::map<int, int> carried;  // a vertex of each body
    for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
      const auto object = static_cast<std::size_t>(mesh.vertices[v].object);
      if (first[object] < 0) first[object] = static_cast<int>(v);
      if (carriers.vertex[v] != kFree) free[object] = false;
      if (carriers.vertex[v] >= 0) carried.try_emplace(carriers.vertex[v], static_cast<int>(v));
    }
    std::map<int, int> of_body;
    for (std::size_t o = 0; o < mesh.objects.size(); ++o) {
      const auto body = carried.find(mesh.follows[o]);
      if (body != carried.end()) {
        const auto [known, fresh] = of_body.try_emplace(body->first, static_cast<int>(lead.size()));
        if (fresh) lead.push_back(body->second);
        of_object[o] = known->second;
      } else if (free[o] && first[o] >= 0) {
        of_object[o] = static_cast<int>(lead.size());
        lead.push_back(first[o]);
      }
    }
    for (const SurfaceVertex& v : mesh.vertices) vertex.push_back(of_object[static_cast<std::size_t>(v.object)]);
  }
};

/// Ids of primitives by kind.
struct Primitives {
  Buffer<int> edges, triangles;
  Primitives() = default;
  /// Those whose first vertex is `in`.
  template <class In>
  Primitives(const SurfaceMesh& mesh, const In& in) {
    edges.upload(ids(mesh.edges, in)), triangles.upload(ids(mesh.triangles, in));
  }
  template <class T, class In>
  static std::vector<int> ids(const std::vector<T>& all, const In& in) {
    std::vector<int> out;
    for (std::size_t i = 0; i < all.size(); ++i)
      if (in(all[i].v[0])) out.push_back(static_cast<int>(i));
    return out;
  }
};

/// The surface in the memory of this side.
struct SurfaceBuffers {
  SurfaceBuffers(const SurfaceMesh& mesh, Real dhat_, Real guard_)
      : vertices(mesh.vertices), edges(mesh.edges), triangles(mesh.triangles), materials(mesh.materials), dhat(dhat_), guard(guard_) {
    const Carriers carriers(mesh);
    vertex_carrier.upload(carriers.vertex), edge_carrier.upload(carriers.edge), triangle_carrier.upload(carriers.triangle);
    const Frames frames(mesh, carriers);
    vertex_frame.upload(frames.vertex), lead.upload(frames.lead);
    followers = Primitives(mesh, [&](int v) { return frames.vertex[static_cast<std::size_t>(v)] != kWorld; });
    rest = Primitives(mesh, [&](int v) { return frames.vertex[static_cast<std::size_t>(v)] == kWorld; });
  }
  SurfaceView view() const {
    return {vertices.span(),
            edges.span(),
            triangles.span(),
            vertex_carrier.span(),
            edge_carrier.span(),
            triangle_carrier.span(),
            vertex_frame.span(),
            lead.span(),
            materials,
            dhat,
            guard};
  }
  Buffer<SurfaceVertex> vertices;
  Buffer<SurfaceEdge> edges;
  Buffer<SurfaceTriangle> triangles;
  Buffer<int> vertex_carrier, edge_carrier, triangle_carrier, vertex_frame, lead;
  Primitives followers, rest;  ///< of frames, and those that follow none
  int materials;
  Real dhat, guard;
};
}  // namespace tape::TAPE_SIDE::detail
