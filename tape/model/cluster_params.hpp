#pragma once
#include <array>
#include <string_view>

#include "tape/core/settings.hpp"

namespace tape {
/// What of a collar vertex's way from where its cluster would carry it counts for the gate: all of it, or its part towards or off the
/// roll's axis, which the creep of soft layers around a driven core does not open.
enum class Gate { euclidean, radial };
constexpr auto enum_names(Gate) { return std::array<std::string_view, 2>{"euclidean", "radial"}; }

/// How the wound part of a roll is reduced to a rigid cluster [the paper, III-C].
struct ClusterParams {
  int collar = 10;
  Gate gate = Gate::euclidean;
  Real gate_distance = 5;
  Real seat = 0.2;
  template <class F>
  void fields(F&& f) {
    f("collar", collar, "1", Range::closed(1, 1000), "N, edges of the mesh between the cluster and the free tape; at 1 it never moves");
    f("gate", gate, "", Range::any(), "motion of a collar vertex that counts: all of it, or along the roll's radius");
    f("gate_distance", gate_distance, "1", Range::above(0, 1e4),
      "delta, motion at which a collar vertex may become free, in units of dhat");
    f("seat", seat, "1", Range::closed(0, 0.25),
      "part of the smallest gap between cluster and hub by which they may move against each other while their pairs sleep; 0: they never "
      "do");
  }
};
}  // namespace tape
