#include <array>
#include <map>

#include "tape/step/world.hpp"

namespace tape {
namespace {
/// Rest area [m^2] of a triangle: flat for strips, as placed for bodies.
Real rest_area(const Assembly& a, const Index3& t, bool strip) {
  const auto x = [&](int i) { return a.x[static_cast<std::size_t>(t[i])]; };
  const auto r = [&](int i) { return a.rest[static_cast<std::size_t>(t[i])]; };
  if (!strip) return (x(1) - x(0)).cross(x(2) - x(0)).norm() / 2;
  const Vec2 e1 = r(1) - r(0), e2 = r(2) - r(0);
  return (e1.x() * e2.y() - e1.y() * e2.x()) / 2;
}
Real rest_length2(const Assembly& a, int i, int j, bool strip) {
  const auto u = static_cast<std::size_t>(i), v = static_cast<std::size_t>(j);
  return strip ? (a.rest[u] - a.rest[v]).squaredNorm() : (a.x[u] - a.x[v]).squaredNorm();
}

void add_vertices(SurfaceMesh& mesh, int count, Real xi, int object, int material) {
  for (int i = 0; i < count; ++i) mesh.vertices.push_back({.xi = xi, .area = 0, .object = object, .material = material});
}

void add_triangles(SurfaceMesh& mesh, const Assembly& a, int first, int count, bool strip) {
  std::map<std::array<int, 2>, std::size_t> edges;
  for (int k = first; k < first + count; ++k) {
    const Index3& t = a.triangles[static_cast<std::size_t>(k)];
    const Real area = rest_area(a, t, strip);
    mesh.triangles.push_back({{t[0], t[1], t[2]}, area});
    for (int i = 0; i < 3; ++i) {
      mesh.vertices[static_cast<std::size_t>(t[i])].area += area / 3;
      const int v = std::min(t[i], t[(i + 1) % 3]), w = std::max(t[i], t[(i + 1) % 3]);
      const auto [at, fresh] = edges.try_emplace({v, w}, mesh.edges.size());
      if (fresh) mesh.edges.push_back({{v, w}, 0, rest_length2(a, v, w, strip)});
      mesh.edges[at->second].area += area / 3;
    }
  }
}

/// A flat strip must not feel itself: no cell may be thinner than the contact distance.
void check_cells(const SurfaceMesh& mesh, const Assembly& a, const Scene& scene) {
  for (std::size_t s = 0; s < a.strips.size(); ++s) {
    const StripPart& part = a.strips[s];
    const Real reach = 2 * scene.films[static_cast<std::size_t>(part.film)].xi + scene.dhat();
    for (int k = part.first_triangle; k < part.first_triangle + part.triangles; ++k) {
      const SurfaceTriangle& t = mesh.triangles[static_cast<std::size_t>(k)];
      Real longest2 = 0;
      for (int i = 0; i < 3; ++i) longest2 = std::max(longest2, rest_length2(a, t.v[i], t.v[(i + 1) % 3], true));
      const Real height = 2 * t.area / std::sqrt(longest2);
      if (height <= reach)
        throw InputError("strip '" + scene.strips[s].name + "': a cell " + to_text(height) +
                         " m high touches its own neighbours (2 xi + dhat = " + to_text(reach) +
                         " m): use fewer cells or a smaller contact.dhat");
    }
  }
}
}  // namespace

SurfaceMesh make_surface(const Scene& scene, const Assembly& a) {
  SurfaceMesh mesh;
  mesh.materials = static_cast<int>(scene.materials.size());
  mesh.owner.assign(a.owner.begin(), a.owner.begin() + a.surface_vertices);
  for (const Strip& strip : scene.strips) {
    const StripPart& part = a.strips[mesh.objects.size()];
    add_vertices(mesh, part.vertices, scene.films[static_cast<std::size_t>(part.film)].xi, static_cast<int>(mesh.objects.size()),
                 strip.material);
    add_triangles(mesh, a, part.first_triangle, part.triangles, true);
    mesh.objects.push_back(strip.name);
  }
  for (std::size_t b = 0; b < scene.bodies.size(); ++b) {
    const BodyPart& part = a.bodies[b];
    add_vertices(mesh, part.vertices, scene.bodies[b].xi, static_cast<int>(mesh.objects.size()), scene.bodies[b].material);
    add_triangles(mesh, a, part.first_triangle, part.triangles, false);
    mesh.objects.push_back(scene.bodies[b].name);
  }
  check_cells(mesh, a, scene);
  return mesh;
}
}  // namespace tape
