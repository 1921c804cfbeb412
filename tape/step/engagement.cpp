#include "tape/step/engagement.hpp"

#include <algorithm>

namespace tape {
namespace {
const SurfaceTriangle& triangle(const World& world, int t) { return world.surface.triangles[static_cast<std::size_t>(t)]; }
int material(const World& world, int v) { return world.surface.vertices[static_cast<std::size_t>(v)].material; }

/// Vertices of what sticks to the triangle of a pair.
std::vector<int> stuck(const World&, const VertexTriangle& pair) { return {pair.vertex}; }
std::vector<int> stuck(const World& world, const SampleTriangle& pair) {
  const int n = params<CohesiveZone>(world.setup.effects).samples;
  const SurfaceTriangle& own = triangle(world, pair.sample / (n * n));
  return {std::begin(own.v), std::end(own.v)};
}
}  // namespace

std::vector<Real> vertex_engagement(const World& world, const State& state) {
  std::vector<Real> engagement(state.x.size(), 0);
  EffectMemory memory = state.memory;
  for_each_memory(memory, [&](const auto& pairs) {
    for (const auto& m : pairs) {
      std::vector<int> vertices = stuck(world, m);
      const SurfaceTriangle& other = triangle(world, m.triangle);
      const Real value = m.engagement(world.setup.scene.adhesion(material(world, vertices[0]), material(world, other.v[0])));
      vertices.insert(vertices.end(), std::begin(other.v), std::end(other.v));
      for (int v : vertices)
        if (v < std::ssize(engagement)) engagement[static_cast<std::size_t>(v)] = std::max(engagement[static_cast<std::size_t>(v)], value);
    }
  });
  return engagement;
}
}  // namespace tape
