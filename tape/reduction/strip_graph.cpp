#include "tape/reduction/strip_graph.hpp"

#include <deque>
#include <set>

namespace tape {
StripGraph::StripGraph(const Assembly& assembly, const StripPart& strip) {
  std::vector<std::set<int>> around(static_cast<std::size_t>(strip.vertices));
  for (int t = strip.first_triangle; t < strip.first_triangle + strip.triangles; ++t)
    for (int a : assembly.triangles[static_cast<std::size_t>(t)])
      for (int b : assembly.triangles[static_cast<std::size_t>(t)])
        if (a != b) around[static_cast<std::size_t>(a - strip.first_vertex)].insert(b - strip.first_vertex);
  begin_.push_back(0);
  for (const std::set<int>& near : around) {
    neighbour_.insert(neighbour_.end(), near.begin(), near.end());
    begin_.push_back(static_cast<int>(neighbour_.size()));
  }
}

void StripGraph::spread(const std::vector<int>& sources, std::vector<int>& distance) const {
  std::deque<int> next(sources.begin(), sources.end());
  for (int v : sources) distance[static_cast<std::size_t>(v)] = 0;
  for (; !next.empty(); next.pop_front()) {
    const int beyond = distance[static_cast<std::size_t>(next.front())] + 1;
    for (int w : neighbours(next.front())) {
      if (distance[static_cast<std::size_t>(w)] <= beyond) continue;
      distance[static_cast<std::size_t>(w)] = beyond;
      next.push_back(w);
    }
  }
}

void StripGraph::flood(std::vector<int>& label) const {
  std::deque<int> next;
  for (int v = 0; v < vertices(); ++v)
    if (label[static_cast<std::size_t>(v)] >= 0) next.push_back(v);
  for (; !next.empty(); next.pop_front())
    for (int w : neighbours(next.front())) {
      int& of_neighbour = label[static_cast<std::size_t>(w)];
      if (of_neighbour >= 0) continue;
      of_neighbour = label[static_cast<std::size_t>(next.front())];
      next.push_back(w);
    }
}
}  // namespace tape
