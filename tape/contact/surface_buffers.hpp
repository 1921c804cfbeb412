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
  explicit Carriers(const SurfaceMesh& mesh) : Carriers(mesh, mesh.owner) {}
  /// @param owner  [nv] if not as the mesh says
  Carriers(const SurfaceMesh& mesh, const std::vector<VertexOwner>& owner) {
    for (const VertexOwner& o : owner) vertex.push_back(o.block < 0 ? kFixed : o.body < 0 ? kFree : o.body);
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
  std::vector<Home> home = {{}};
  Frames(const SurfaceMesh& mesh, const Carriers& carriers, const std::map<int, Vec3>& clusters) {
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
        if (fresh) {
          const auto cluster = clusters.find(body->first);
          lead.push_back(body->second);
          home.push_back(cluster == clusters.end() ? Home{} : Home{true, cluster->second});
        }
        of_object[o] = known->second;
      } else if (free[o] && first[o] >= 0) {
        of_object[o] = static_cast<int>(lead.size());
        lead.push_back(first[o]);
        home.push_back({});
      }
    }
    for (const SurfaceVertex& v : mesh.vertices) vertex.push_back(of_object[static_cast<std::size_t>(v.object)]);
  }
};

/// Ids of primitives by kind, those that are `in`.
struct Primitives {
  Buffer<int> vertices, edges, triangles;
  Primitives() = default;
  /// @param in  of a vertex, and of the vertices of an edge or triangle
  template <class In>
  Primitives(const SurfaceMesh& mesh, const In& in) {
    std::vector<int> ids;
    for (int v = 0; v < static_cast<int>(mesh.vertices.size()); ++v)
      if (in(std::span<const int>(&v, 1))) ids.push_back(v);
    vertices.upload(ids), edges.upload(list(mesh.edges, in)), triangles.upload(list(mesh.triangles, in));
  }
  int size() const { return vertices.size() + edges.size() + triangles.size(); }

 private:
  template <class T, class In>
  static std::vector<int> list(const std::vector<T>& all, const In& in) {
    std::vector<int> out;
    for (std::size_t i = 0; i < all.size(); ++i)
      if (in(std::span<const int>(all[i].v))) out.push_back(static_cast<int>(i));
    return out;
  }
};

/// The surface in the memory of this side.
struct SurfaceBuffers {
  SurfaceBuffers(const SurfaceMesh& mesh, Real dhat_, Real guard_)
      : vertices(mesh.vertices),
        edges(mesh.edges),
        triangles(mesh.triangles),
        kappa(mesh.kappa),
        objects(static_cast<int>(mesh.objects.size())),
        materials(mesh.materials),
        dhat(dhat_),
        guard(guard_) {
    const auto object = [&](int v) { return mesh.vertices[static_cast<std::size_t>(v)].object; };
    const auto first_of_objects = [&](std::size_t n, const auto& object_of) {
      std::vector<int> first(mesh.objects.size() + 1, static_cast<int>(n));
      for (std::size_t i = n; i-- > 0;) first[static_cast<std::size_t>(object_of(i))] = static_cast<int>(i);
      for (std::size_t o = mesh.objects.size(); o-- > 0;) first[o] = std::min(first[o], first[o + 1]);
      return first;
    };
    first_vertex.upload(first_of_objects(mesh.vertices.size(), [&](std::size_t v) { return object(static_cast<int>(v)); }));
    first_triangle.upload(first_of_objects(mesh.triangles.size(), [&](std::size_t t) { return object(mesh.triangles[t].v[0]); }));
    for (std::size_t o = 0, n = mesh.objects.size(); o < n; ++o)
      is_outside.push_back(std::any_of(mesh.apart.begin() + static_cast<std::ptrdiff_t>(mesh.apart.empty() ? 0 : o * n),
                                       mesh.apart.begin() + static_cast<std::ptrdiff_t>(mesh.apart.empty() ? 0 : (o + 1) * n),
                                       [](char c) { return c != 0; }));
    set_apart(mesh.apart);
    set_carriage(mesh, {}, {});
  }
  void set_apart(const std::vector<char>& matrix) {
    const std::size_t n = is_outside.size();
    std::vector<char> all(matrix.empty() ? 0 : n, 0);
    for (std::size_t o = 0; o < all.size(); ++o) {
      all[o] = is_outside[o] ? 1 : 0;
      for (std::size_t p = 0; p < n && all[o] != 0; ++p)
        if (is_outside[p] && matrix[o * n + p] == 0) all[o] = 0;
    }
    apart.upload(matrix), shuns.upload(all);
  }
  /// Sorts the primitives by what they follow and whether they sleep: whether all their vertices are members of a cluster.
  /// @param clusters, resting  as of SurfaceCarriage
  void set_carriage(const SurfaceMesh& mesh, const std::map<int, Vec3>& clusters, const std::map<int, int>& resting) {
    const Carriers carriers(mesh);
    const auto as_one = [&](std::vector<int> carrier) {
      for (int& body : carrier)
        if (const auto on = resting.find(body); on != resting.end()) body = on->second;
      return carrier;
    };
    vertex_carrier.upload(as_one(carriers.vertex));
    edge_carrier.upload(as_one(carriers.edge)), triangle_carrier.upload(as_one(carriers.triangle));
    const Frames frames(mesh, carriers, clusters);
    vertex_frame.upload(frames.vertex), lead.upload(frames.lead), home.upload(frames.home);
    std::vector<char> sleeps;
    for (int carrier : carriers.vertex) sleeps.push_back(clusters.contains(carrier) ? 1 : 0);
    member.upload(sleeps);
    std::vector<char> framed(mesh.objects.size(), 0), free(mesh.objects.size(), 0);
    for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
      const auto object = static_cast<std::size_t>(mesh.vertices[v].object);
      if (frames.vertex[v] != kWorld)
        framed[object] = 1;
      else if (carriers.vertex[v] == kFree)
        free[object] = 1;
    }
    has_frame.upload(framed), touches_itself.upload(free);
    std::vector<char> still(mesh.objects.size(), 1);
    for (std::size_t v = 0; v < mesh.vertices.size(); ++v)
      if (carriers.vertex[v] != kFixed) still[static_cast<std::size_t>(mesh.vertices[v].object)] = 0;
    fixed.upload(still);
    const auto follows = [&](int v) { return frames.vertex[static_cast<std::size_t>(v)] != kWorld; };
    const auto is_asleep = [&](std::span<const int> v) {
      return sleeps[static_cast<std::size_t>(v[0])] != 0 && carriers.common(v) != kFree;
    };
    const auto pick = [&](bool following, bool sleeping) {
      return Primitives(
          mesh, [&, following, sleeping](std::span<const int> v) { return follows(v[0]) == following && is_asleep(v) == sleeping; });
    };
    const auto out = [&](int v) { return is_outside[static_cast<std::size_t>(mesh.vertices[static_cast<std::size_t>(v)].object)]; };
    followers = pick(true, false), asleep = pick(true, true);
    rest = Primitives(mesh, [&](std::span<const int> v) { return !follows(v[0]) && !out(v[0]); });
    outside = Primitives(mesh, [&](std::span<const int> v) { return out(v[0]); });
    TAPE_CHECK(pick(false, true).size() == 0);
    alone = rest.size() + outside.size() == 0 && frames.lead.size() == 2;
    everything = {}, all_followers = {};
    if (alone) return;
    everything = Primitives(mesh, [](std::span<const int>) { return true; });
    all_followers = Primitives(mesh, [&](std::span<const int> v) { return follows(v[0]); });
  }
  /// What looks for pairs: all that is not asleep, and what sleeps where something may come near that does not follow its frame.
  const Primitives& in_view() const { return alone ? followers : everything; }
  SurfaceView view() const {
    return {vertices.span(),
            edges.span(),
            triangles.span(),
            vertex_carrier.span(),
            edge_carrier.span(),
            triangle_carrier.span(),
            vertex_frame.span(),
            lead.span(),
            member.span(),
            apart.span(),
            shuns.span(),
            kappa.span(),
            objects,
            materials,
            dhat,
            guard};
  }
  Buffer<SurfaceVertex> vertices;
  Buffer<SurfaceEdge> edges;
  Buffer<SurfaceTriangle> triangles;
  Buffer<Real> kappa;
  Buffer<int> vertex_carrier, edge_carrier, triangle_carrier, vertex_frame, lead;
  Buffer<Home> home;                     ///< [frames]
  Buffer<char> member;                   ///< [nv]
  Buffer<int> first_vertex;              ///< [objects + 1] vertices of an object are consecutive
  Buffer<int> first_triangle;            ///< [objects + 1] and so are its triangles
  Buffer<char> has_frame;                ///< [objects] 1: is seen from one
  Buffer<char> fixed;                    ///< [objects] 1: all of it is
  Buffer<char> touches_itself;           ///< [objects] 1: and is seen from the world alone
  Buffer<char> apart;                    ///< [objects objects], or empty
  Buffer<char> shuns;                    ///< [objects], or empty
  Primitives followers, asleep;          ///< of frames, awake and asleep
  Primitives rest, outside;              ///< that follow none; the second of objects that are kept apart from others
  Primitives everything, all_followers;  ///< all, and those of frames; empty if alone
  bool alone = false;                    ///< everything follows one frame: nothing need be seen from the world
  std::vector<bool> is_outside;          ///< [objects] kept apart from others, when it all began
  int objects, materials;
  Real dhat, guard;
};
}  // namespace tape::TAPE_SIDE::detail
