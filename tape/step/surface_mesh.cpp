#include <algorithm>
#include <cmath>

#include "tape/step/world.hpp"

namespace tape {
namespace {
std::vector<Index3> triangles_of(const Assembly& a, int first, int count, int first_vertex) {
  std::vector<Index3> out;
  for (int k = first; k < first + count; ++k) out.emplace_back(a.triangles[static_cast<std::size_t>(k)].array() - first_vertex);
  return out;
}

/// A flat strip must not feel itself: no cell may be thinner than the contact distance.
void check_cells(const Assembly& a, const Scene& scene) {
  for (std::size_t s = 0; s < a.strips.size(); ++s) {
    const StripPart& part = a.strips[s];
    const Real reach = 2 * scene.films[static_cast<std::size_t>(part.film)].xi + scene.dhat();
    for (int k = part.first_triangle; k < part.first_triangle + part.triangles; ++k) {
      const Index3& t = a.triangles[static_cast<std::size_t>(k)];
      const auto x = [&](int i) { return a.rest[static_cast<std::size_t>(t[i % 3])]; };
      const Vec2 e1 = x(1) - x(0), e2 = x(2) - x(0);
      Real longest2 = 0;
      for (int i = 0; i < 3; ++i) longest2 = std::max(longest2, (x(i + 1) - x(i)).squaredNorm());
      const Real height = (e1.x() * e2.y() - e1.y() * e2.x()) / std::sqrt(longest2);
      if (height <= reach)
        throw InputError("strip '" + scene.strips[s].name + "': a cell " + to_text(height) +
                         " m high touches its own neighbours (2 xi + dhat = " + to_text(reach) +
                         " m): use fewer cells or a smaller contact.dhat");
    }
  }
}
/// What somebody else simulates, from each other.
void keep_apart(const Scene& scene, const Assembly& a, SurfaceMesh& mesh) {
  if (a.articulations.empty()) return;
  const auto object_of = [&](int body) { return static_cast<int>(scene.strips.size()) + body; };
  const std::size_t n = mesh.objects.size();
  mesh.apart.assign(n * n, 0);
  for (std::size_t b = 0; b < scene.bodies.size(); ++b)
    for (std::size_t c = 0; c < scene.bodies.size(); ++c)
      mesh.apart[(scene.strips.size() + b) * n + scene.strips.size() + c] = scene.bodies[b].outside && scene.bodies[c].outside ? 1 : 0;
  for (const ArticulationPart& part : a.articulations) {
    JointlyMoved& joint = mesh.together.emplace_back();
    for (int body : part.links) joint.objects.push_back(object_of(body));
    joint.first_block = part.first_block, joint.blocks = part.blocks;
  }
}
/// Axles and grips hold firmly: were one end to take less of a step than the other, the step would no longer lead downhill.
void tie(const Scene& scene, SurfaceMesh& mesh) {
  const auto object = [&](const std::string& name) {
    return static_cast<int>(std::ranges::find(mesh.objects, name) - mesh.objects.begin());
  };
  for (const AxleJoint& axle : scene.axles)
    if (!axle.to.empty()) mesh.tied.emplace_back(object(axle.body), object(axle.to));
  for (const Grip& grip : scene.grips)
    if (!grip.to.empty()) mesh.tied.emplace_back(object(grip.what.object), object(grip.to));
}
}  // namespace

SurfaceMesh make_surface(const Scene& scene, const Assembly& a) {
  check_cells(a, scene);
  SurfaceMesh mesh;
  mesh.materials = static_cast<int>(scene.materials.size());
  mesh.kappa.clear();
  for (int m = 0; m < mesh.materials; ++m)
    for (int n = 0; n < mesh.materials; ++n) mesh.kappa.push_back(scene.kappa(m, n));
  const auto owners = [&](int first, int count) {
    return std::vector<VertexOwner>(a.owner.begin() + first, a.owner.begin() + first + count);
  };
  for (const Strip& strip : scene.strips) {
    const StripPart& part = a.strips[mesh.objects.size()];
    std::vector<Vec3> flat;
    for (int v = part.first_vertex; v < part.first_vertex + part.vertices; ++v) {
      const Vec2& rest = a.rest[static_cast<std::size_t>(v)];
      flat.emplace_back(rest.x(), rest.y(), 0);
    }
    mesh.add_object(strip.name, flat, owners(part.first_vertex, part.vertices),
                    triangles_of(a, part.first_triangle, part.triangles, part.first_vertex),
                    scene.films[static_cast<std::size_t>(part.film)].xi, strip.material, part.hub);
  }
  for (std::size_t b = 0; b < scene.bodies.size(); ++b) {
    const BodyPart& part = a.bodies[b];
    const std::vector<Vec3> placed(a.x.begin() + part.first_vertex, a.x.begin() + part.first_vertex + part.vertices);
    const bool hub = std::ranges::find(a.strips, static_cast<int>(b), &StripPart::hub) != a.strips.end();
    mesh.add_object(scene.bodies[b].name, placed, owners(part.first_vertex, part.vertices),
                    triangles_of(a, part.first_triangle, part.triangles, part.first_vertex), scene.bodies[b].xi, scene.bodies[b].material,
                    hub ? static_cast<int>(b) : -1);
  }
  keep_apart(scene, a, mesh);
  tie(scene, mesh);
  return mesh;
}
}  // namespace tape
