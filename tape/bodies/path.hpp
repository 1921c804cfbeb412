#pragma once
#include "tape/bodies/vertex_owner.hpp"
#include "tape/core/types.hpp"
#include "tape/math/rotation.hpp"

namespace tape {
/// A vertex over a trial step: x(t) = centre + exp(t spin) arm + t velocity, t in [0, 1]. Free vertices have no arm, unless they ride a
/// body.
struct VertexPath {
  Vec3 centre;    ///< [m]
  Vec3 velocity;  ///< [m] per whole step
  Vec3 arm;       ///< [m]
  Vec3 spin;      ///< [rad] per whole step
  TAPE_HD Vec3 at(Real t) const { return centre + t * velocity + (straight() ? arm : rotate(t * spin, arm)); }
  /// Also where the square of the spin underflows: its norm is then 0, and no such turn moves anything.
  TAPE_HD bool straight() const { return spin.squaredNorm() == 0; }
};

/// Paths of all vertices along a direction of the unknowns.
struct PathView {
  Span<const Vec3> x;             ///< [nv] m, where the paths start
  Span<const VertexOwner> owner;  ///< [nv]
  Span<const Vec3> direction;     ///< [nb] m and rad
  Span<const Pose> body;          ///< [bodies] X_WB where the paths start
  TAPE_HD VertexPath operator[](int v) const {
    const VertexOwner o = owner[v];
    if (o.block < 0) return {x[v], Vec3::Zero(), Vec3::Zero(), Vec3::Zero()};
    if (o.body < 0) return o.ride < 0 ? straight(v) : riding(v);
    return carried(v);
  }
  /// Of the body that carries vertex v, else of a frame that does not turn, at the vertex itself.
  TAPE_HD Pose frame(int v) const { return owner[v].body < 0 ? Pose{Mat3::Identity(), x[v]} : body[owner[v].body]; }

 private:
  TAPE_HD VertexPath straight(int v) const { return {x[v], direction[owner[v].block], Vec3::Zero(), Vec3::Zero()}; }
  /// Turns about the centre of its body, or of the one that its body rides, from which the way of its own centre is an arc: two bodies that
  /// turn as one keep their places to each other.
  TAPE_HD VertexPath carried(int v) const {
    const VertexOwner o = owner[v];
    const Vec3 own = body[o.body].position, pivot = o.ride < 0 ? own : body[o.ride].position, spin = direction[o.block + 1];
    return {pivot, direction[o.block] + spin.cross(pivot - own), x[v] - pivot, spin};
  }
  /// Sets out as the direction says and turns with the body, the more so the less the direction differs from the body's motion there.
  /// On chords a roll that turns by an angle a becomes a^2/2 wider, which stiff tape does not allow.
  TAPE_HD VertexPath riding(int v) const {
    const VertexOwner o = owner[v];
    const Vec3 spin = direction[o.ride_block + 1], arm = x[v] - body[o.ride].position, turn = spin.cross(arm);
    const Real apart = (direction[o.block] - direction[o.ride_block] - turn).squaredNorm(), all = turn.squaredNorm();
    if (!(apart < all)) return straight(v);
    const Real share = (1 - apart / all) * (1 - apart / all);
    return {body[o.ride].position, direction[o.block] - share * turn, arm, share * spin};
  }
};
}  // namespace tape
