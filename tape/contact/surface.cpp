#include "tape/contact/surface.hpp"

#include <algorithm>
#include <array>
#include <map>

#include "tape/core/error.hpp"

namespace tape {
namespace {
using Ends = std::array<int, 2>;
Ends ends_of(const SurfaceTriangle& t, int k) {
  const int a = t.v[k], b = t.v[(k + 1) % 3];
  return {std::min(a, b), std::max(a, b)};
}
}  // namespace

void SurfaceMesh::add_object(const std::string& name, const std::vector<Vec3>& rest, const std::vector<VertexOwner>& owners,
                             const std::vector<Index3>& added, Real xi, int material, int follows_body) {
  TAPE_CHECK(owners.size() == rest.size());
  const std::size_t first_vertex = vertices.size(), first_triangle = triangles.size();
  const auto x = [&](int v) -> const Vec3& { return rest[static_cast<std::size_t>(v) - first_vertex]; };
  const auto vertex = [&](int v) -> SurfaceVertex& { return vertices[static_cast<std::size_t>(v)]; };
  for (const VertexOwner& o : owners) {
    vertices.push_back({.xi = xi, .area = 0, .object = static_cast<int>(objects.size()), .material = material, .rim = false});
    owner.push_back(o);
  }
  objects.push_back(name);
  follows.push_back(follows_body);

  struct Edge {
    Real area = 0;
    std::uint16_t triangles = 0;
  };
  Real total = 0;
  std::map<Ends, Edge> edge_of;
  std::vector<std::uint16_t> at_vertex(rest.size(), 0);  // triangles there
  for (const Index3& t : added) {
    triangles.push_back({.v = {}, .area = 0, .mean_area = 0, .sharing = {}, .open = false});
    SurfaceTriangle& triangle = triangles.back();
    for (int k = 0; k < 3; ++k) triangle.v[k] = static_cast<int>(first_vertex) + t[k];
    const int(&v)[3] = triangle.v;
    const Real area = (x(v[1]) - x(v[0])).cross(x(v[2]) - x(v[0])).norm() / 2;
    triangle.area = area;
    total += area;
    for (int k = 0; k < 3; ++k) {
      vertex(v[k]).area += area / 3;
      std::uint16_t& around = at_vertex[static_cast<std::size_t>(t[k])];
      TAPE_CHECK(around < 65535);
      ++around;
      Edge& edge = edge_of[ends_of(triangle, k)];
      edge.area += area / 3;
      ++edge.triangles;
    }
  }
  bool open = false;
  for (const auto& [e, edge] : edge_of) {
    edges.push_back({{e[0], e[1]}, edge.area, (x(e[0]) - x(e[1])).squaredNorm()});
    if (edge.triangles == 1) open = vertex(e[0]).rim = vertex(e[1]).rim = true;
  }
  for (std::size_t i = first_triangle; i < triangles.size(); ++i) {
    SurfaceTriangle& t = triangles[i];
    t.open = open;
    t.mean_area = total / static_cast<Real>(added.size());
    for (int k = 0; k < 3; ++k) {
      t.sharing.edge[k] = edge_of.at(ends_of(t, k)).triangles;
      t.sharing.vertex[k] = vertex(t.v[k]).rim ? std::uint16_t{0} : at_vertex[static_cast<std::size_t>(t.v[k]) - first_vertex];
    }
  }
}
}  // namespace tape
