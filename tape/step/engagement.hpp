#pragma once
#include <vector>

#include "tape/step/world.hpp"

namespace tape {
/// Vertices of what sticks to the triangle of a remembered pair: one, or those of the triangle that a sample lies in.
std::vector<int> sticking_vertices(const World& world, const VertexTriangle& pair);
std::vector<int> sticking_vertices(const World& world, const SampleTriangle& pair);

/// How the materials of a remembered pair adhere.
template <class Name>
Adhesion adhesion_of(const World& world, const Name& pair) {
  const auto material = [&](int v) { return world.surface.vertices[static_cast<std::size_t>(v)].material; };
  const int triangle = world.surface.triangles[static_cast<std::size_t>(pair.triangle)].v[0];
  return world.setup.scene.adhesion(material(sticking_vertices(world, pair)[0]), material(triangle));
}

/// All pairs that are remembered, those asleep too.
template <class F>
void for_each_remembered(const State& state, F&& f) {
  const auto each = [&](const auto&... of_effect) {
    const auto visit = [&]<class T>(const MemoryOf<T>& memory) {
      if constexpr (Remembers<T>)
        for (const auto& pair : memory.pairs) f(pair);
    };
    (visit(of_effect), ...);
  };
  std::apply(each, state.memory);
  for (const Cluster& cluster : state.clusters) std::apply(each, *cluster.asleep);
  if (state.sleepers) std::apply(each, state.sleepers->asleep);
}

/// How much adhesion is left at each vertex of the strips [strip vertices], in [0, 1]: the most of all pairs that name it. Of a pair: its
/// beta; 1 for a bond; of area the stiffness that is left of it. 0 where nothing adheres.
std::vector<Real> vertex_engagement(const World& world, const State& state);
}  // namespace tape
