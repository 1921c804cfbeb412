#pragma once
#include "tape/bodies/body_mass.hpp"
#include "tape/bodies/vertex_fans.hpp"
#include "tape/bodies/vertex_owner.hpp"
#include "tape/core/types.hpp"
#include "tape/model/adhesion.hpp"

namespace tape {
/// What an effect sees of the world at a trial configuration. All arrays are memory of the side that runs.
struct StateView {
  Real dt;                          ///< [s]
  bool overshot;                    ///< the last Newton update raised the energy and was shortened
  Span<const Vec3> x;               ///< [nv] m, now
  Span<const Vec3> x_start;         ///< [nv] m, at the start of the step
  Span<const Vec3> x_tilde;         ///< [nv] m, where inertia alone would take strip vertices (without gravity)
  Span<const VertexOwner> owner;    ///< [nv]
  Span<const Real> mass;            ///< [nv] kg: of free strip vertices, and of whole bodies at their centres
  Span<const BodyMass> body_mass;   ///< [bodies]
  Span<const Pose> body;            ///< [bodies] X_WB now
  Span<const Pose> body_target;     ///< [bodies] X_WB that inertia (dynamic) or the script (driven) asks for at the end of the step
  Span<const Vec3> grip_target;     ///< [springs] m, at the end of the step
  Span<const Real> grip_stiffness;  ///< [springs] N/m, 0 while the grip is open
  Span<const Real> mu;              ///< [materials^2] friction by ContactPair::interface
  Span<const Adhesion> adhesion;    ///< [materials^2] by ContactPair::interface
  VertexFans fans;                  ///< at the end of a step only
};

/// Ids that an element touches: vertices, or blocks of unknowns for effects with `on_blocks`.
template <int K>
struct Stencil {
  static constexpr int size = K;
  int id[K];
};
}  // namespace tape
