#pragma once
#include "tape/core/settings.hpp"

namespace tape {
/// When tape that lies still on a body sleeps there.
struct SleepParams {
  Real after = 0;
  Real move = 0.005;
  int edges = 3;
  template <class F>
  void fields(F&& f) {
    f("after", after, "s", Range::closed(0, 1e6),
      "tape that adheres to a body sleeps there if it has lain still for so long; 0: it never does");
    f("move", move, "1", Range::above(0, 1), "most that still tape moves against its body in that time, in units of dhat; more wakes it");
    f("edges", edges, "1", Range::closed(1, 1000), "edges of the mesh between tape that sleeps and what moves");
  }
};
}  // namespace tape
