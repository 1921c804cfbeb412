#pragma once
#include <vector>

#include "tape/core/types.hpp"
#include "tape/effects/seat.hpp"

namespace tape {
/// Where a cluster stands on its hub.
struct OnHub {
  Vec3 foot = Vec3::Zero();      ///< [m] point of the cluster at the hub's centre, a y (Cluster::local)
  Mat3 turn = Mat3::Identity();  ///< R_h^T R_c
};
/// @param centre  [m] of the cluster, a y
OnHub on_hub(const Pose& hub, const Pose& cluster, const Vec3& centre);
/// Pose of a cluster that stands on a hub so. @param centre  [m] of the cluster, a y
Pose stands(const OnHub& at, const Pose& hub, const Vec3& centre);

/// A cluster that rests on its hub: the pairs between them sleep, and Seat has their energy.
struct Rest {
  OnHub at;
  PlaceForm form;
  Real reach = 0;             ///< [m] from there to where it ends
  Real radius = 0;            ///< [m] of the hub about its centre
  std::vector<int> vertices;  ///< members that touch or adhere to the hub, counted from the first of the strip
  /// All numbers of it; how many vertices there are is known.
  template <class F>
  void visit(F&& f) {
    for (int k = 0; k < 3; ++k) f(at.foot[k]);
    for (int k = 0; k < 9; ++k) f(at.turn.data()[k]);
    f(form.energy);
    for (int k = 0; k < 6; ++k) f(form.force[k]);
    for (int k = 0; k < 36; ++k) f(form.stiffness.data()[k]);
    f(reach), f(radius);
    for (int& v : vertices) f(v);
  }
};
/// [m] bound on how far members within a radius [m] about the foot are from where they stood.
Real displaced(const OnHub& at, Real radius, const Pose& hub, const Pose& cluster, const Vec3& centre);
}  // namespace tape
