#include "tape/reduction/cluster.hpp"

#include <algorithm>
#include <cmath>

namespace tape {
namespace {
template <class T>
const T& at(const std::vector<T>& values, int i) {
  return values[static_cast<std::size_t>(i)];
}

/// Calls f(v) for each vertex of a remembered pair.
template <class F>
void for_each_vertex(const Assembly& a, int, const VertexTriangle& pair, const F& f) {
  f(pair.vertex);
  for (int v : at(a.triangles, pair.triangle)) f(v);
}
template <class F>
void for_each_vertex(const Assembly& a, int samples, const SampleTriangle& pair, const F& f) {
  for (int v : at(a.triangles, pair.sample / (samples * samples))) f(v);
  for (int v : at(a.triangles, pair.triangle)) f(v);
}
}  // namespace

std::vector<bool> members(const Assembly& assembly, const StripPart& strip, const Cluster& cluster, int collar) {
  std::vector<bool> member(static_cast<std::size_t>(strip.vertices), false);
  for (int t = strip.first_triangle; t < strip.first_triangle + strip.triangles; ++t) {
    const Index3 v = at(assembly.triangles, t).array() - strip.first_vertex;
    if (std::ranges::all_of(v, [&](int w) { return at(*cluster.distance, w) >= collar; }))
      for (int w : v) member[static_cast<std::size_t>(w)] = true;
  }
  return member;
}

Cluster form_cluster(const Assembly& assembly, const StripPart& strip, const StripGraph& graph, const EffectMemory& memory,
                     const std::vector<Vec3>& x, int samples, int collar) {
  Cluster cluster;
  cluster.local =
      std::make_shared<const std::vector<Vec3>>(x.begin() + strip.first_vertex, x.begin() + strip.first_vertex + strip.vertices);
  std::vector<int> distance(static_cast<std::size_t>(strip.vertices), collar);
  const auto along = [&](int v) { return at(assembly.rest, strip.first_vertex + v).x(); };
  Real last = -std::numeric_limits<Real>::infinity(), end = last;
  for (int v : vertices_of(assembly, samples, memory))
    if (v >= strip.first_vertex && v < strip.first_vertex + strip.vertices) last = std::max(last, along(v - strip.first_vertex));
  for (int v = 0; v < strip.vertices; ++v) end = std::max(end, along(v));
  std::vector<int> free;
  constexpr Real kEdge = 1e-9;  // [m]
  for (int v = 0; v < strip.vertices; ++v)
    if (along(v) > last || along(v) > end - kEdge) free.push_back(v);
  graph.spread(free, distance);
  cluster.distance = std::make_shared<const std::vector<int>>(std::move(distance));
  return cluster;
}

void weigh(const Assembly& assembly, const StripPart& strip, const std::vector<bool>& member, Cluster& cluster) {
  Real mass = 0;
  Vec3 first = Vec3::Zero();
  const auto for_each_member = [&](const auto& f) {
    for (int v = 0; v < strip.vertices; ++v)
      if (member[static_cast<std::size_t>(v)]) f(at(assembly.mass, strip.first_vertex + v), at(*cluster.local, v));
  };
  for_each_member([&](Real m, const Vec3& y) { mass += m, first += m * y; });
  if (mass == 0) {
    cluster.mass = {1, Mat3::Identity()};
    return;
  }
  cluster.centre = first / mass;
  cluster.mass = {mass, Mat3::Zero()};
  for_each_member([&](Real m, const Vec3& y) { cluster.mass.second += m * (y - cluster.centre) * (y - cluster.centre).transpose(); });
}

std::vector<int> vertices_of(const Assembly& assembly, int samples, EffectMemory memory) {
  std::vector<int> vertices;
  for_each_memory(memory, [&](const auto& remembered) {
    for (const auto& pair : remembered) for_each_vertex(assembly, samples, pair, [&](int v) { vertices.push_back(v); });
  });
  return vertices;
}

void sort_pairs(const Assembly& assembly, const std::vector<int>& as_one, int samples, EffectMemory& awake, EffectMemory& asleep) {
  const auto sort = [&]<class T>(MemoryOf<T>& up, MemoryOf<T>& down) {
    if constexpr (Remembers<T>) {
      auto all = std::move(up.pairs);
      all.insert(all.end(), down.pairs.begin(), down.pairs.end());
      std::ranges::sort(all, {}, [](const auto& pair) { return pair.key(); });
      up.pairs.clear(), down.pairs.clear();
      for (const auto& pair : all) {
        const int first = at(as_one, at(assembly.triangles, pair.triangle)[0]);
        bool rigid = first >= 0;
        for_each_vertex(assembly, samples, pair, [&](int v) { rigid &= at(as_one, v) == first; });
        (rigid ? down : up).pairs.push_back(pair);
      }
    }
  };
  std::apply([&](auto&... up) { (sort(up, std::get<std::remove_cvref_t<decltype(up)>>(asleep)), ...); }, awake);
}
}  // namespace tape
