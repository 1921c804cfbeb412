#include "tape/model/sharp_edge.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <set>

namespace tape {
namespace {
using Graph = std::map<int, std::set<int>>;

/// Vertices that sharp edges join.
Graph sharp_graph(const TriangleMesh& mesh, Real angle) {
  const auto at = [&](int v) -> const Vec3& { return mesh.vertices[static_cast<std::size_t>(v)]; };
  std::map<std::pair<int, int>, Vec3> normal;  // of the triangle that has the edge in this direction
  for (const Index3& t : mesh.triangles)
    for (int k = 0; k < 3; ++k) normal[{t[k], t[(k + 1) % 3]}] = (at(t[1]) - at(t[0])).cross(at(t[2]) - at(t[0])).normalized();
  Graph graph;
  for (const auto& [edge, n] : normal) {
    const auto other = normal.find({edge.second, edge.first});
    if (other == normal.end()) continue;
    const Vec3 along = at(edge.second) - at(edge.first);
    const bool convex = n.cross(other->second).dot(along) > 0;
    if (convex && std::numbers::pi - std::acos(std::clamp(n.dot(other->second), -1.0, 1.0)) < angle)
      graph[edge.first].insert(edge.second), graph[edge.second].insert(edge.first);
  }
  return graph;
}

/// Vertices that edges join to this one, itself included.
std::set<int> component(const Graph& graph, int start) {
  std::set<int> found{start};
  for (std::vector<int> next{start}; !next.empty();) {
    const int v = next.back();
    next.pop_back();
    for (int w : graph.at(v))
      if (found.insert(w).second) next.push_back(w);
  }
  return found;
}

/// Vertices of a component in a row; none if it branches.
std::vector<int> as_line(Graph graph, const std::set<int>& vertices) {
  int v = *vertices.begin();
  for (int w : vertices) {
    if (graph[w].size() > 2) return {};
    if (graph[w].size() == 1) v = w;
  }
  std::vector<int> line{v};
  while (!graph[v].empty()) {
    const int next = *graph[v].begin();
    graph[v].erase(next), graph[next].erase(v);
    line.push_back(v = next);
  }
  return line;
}
}  // namespace

std::vector<Vec3> sharp_edge(const TriangleMesh& mesh, Real angle) {
  const TriangleMesh merged = merge_vertices(mesh);
  const Graph graph = sharp_graph(merged, angle);
  std::vector<Vec3> longest;
  Real most = 0;
  std::set<int> seen;
  for (const auto& [start, others] : graph) {
    if (seen.contains(start)) continue;
    const std::set<int> vertices = component(graph, start);
    seen.insert(vertices.begin(), vertices.end());
    std::vector<Vec3> line;
    Real length = 0;
    for (int v : as_line(graph, vertices)) {
      line.push_back(merged.vertices[static_cast<std::size_t>(v)]);
      if (line.size() > 1) length += (line.back() - line[line.size() - 2]).norm();
    }
    if (length > most) most = length, longest = line;
  }
  return longest;
}
}  // namespace tape
