#include "tape/step/engagement.hpp"

#include <algorithm>

namespace tape {
std::vector<int> sticking_vertices(const World&, const VertexTriangle& pair) { return {pair.vertex}; }
std::vector<int> sticking_vertices(const World& world, const SampleTriangle& pair) {
  const int n = params<CohesiveZone>(world.setup.effects).samples;
  const SurfaceTriangle& own = world.surface.triangles[static_cast<std::size_t>(pair.sample / (n * n))];
  return {std::begin(own.v), std::end(own.v)};
}

std::vector<Real> vertex_engagement(const World& world, const State& state) {
  std::vector<Real> engagement(state.x.size(), 0);
  for_each_remembered(state, [&](const auto& m) {
    const Real value = m.engagement(adhesion_of(world, m));
    const SurfaceTriangle& other = world.surface.triangles[static_cast<std::size_t>(m.triangle)];
    std::vector<int> vertices = sticking_vertices(world, m);
    vertices.insert(vertices.end(), std::begin(other.v), std::end(other.v));
    for (int v : vertices)
      if (v < std::ssize(engagement)) engagement[static_cast<std::size_t>(v)] = std::max(engagement[static_cast<std::size_t>(v)], value);
  });
  return engagement;
}
}  // namespace tape
