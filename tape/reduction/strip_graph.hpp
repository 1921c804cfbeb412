#pragma once
#include <span>
#include <vector>

#include "tape/bodies/assembly.hpp"

namespace tape {
/// The vertices of a strip and the edges of its mesh between them. Vertices are counted from the strip's first.
class StripGraph {
 public:
  StripGraph(const Assembly& assembly, const StripPart& strip);
  int vertices() const { return static_cast<int>(begin_.size()) - 1; }
  std::span<const int> neighbours(int v) const {
    return {neighbour_.data() + begin_[static_cast<std::size_t>(v)], neighbour_.data() + begin_[static_cast<std::size_t>(v) + 1]};
  }
  /// Lowers each of `distance` [vertices] to the number of edges to the nearest source where that is less.
  void spread(const std::vector<int>& sources, std::vector<int>& distance) const;
  /// Gives each vertex whose label is -1 that of the nearest by edges with another one, if there is one.
  void flood(std::vector<int>& label) const;

 private:
  std::vector<int> begin_, neighbour_;  ///< of vertex v: neighbour_[begin_[v] ... begin_[v + 1])
};
}  // namespace tape
