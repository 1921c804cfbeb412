#pragma once
#include <vector>

#include "tape/bodies/assembly.hpp"
#include "tape/bodies/path.hpp"
#include "tape/core/side.hpp"
#include "tape/math/rotation.hpp"

namespace tape::TAPE_SIDE {
/// Positions of all vertices, poses of all bodies and coordinates of all articulations on this side: a point in the space of the unknowns.
struct Configuration {
  Buffer<Vec3> x;     ///< [nv] m
  Buffer<Pose> body;  ///< [bodies] X_WB
  Buffer<Vec3> q;     ///< [blocks of articulations] since the start of the step
  void copy_from(const Configuration& other) {
    x.copy_from(other.x);
    body.copy_from(other.body);
    q.copy_from(other.q);
  }
};

namespace coordinates {
struct MoveBody {
  PathView paths;
  Span<const int> block, centre;
  Real step;
  Span<Pose> to;
  TAPE_HD void operator()(int b) const {
    if (block[b] < 0) return;
    const Mat3 turn = rotation_exp(step * paths.direction[block[b] + 1]);
    to[b] = {turn * paths.body[b].rotation, paths[centre[b]].at(step)};
  }
};
struct MoveVertex {
  PathView paths;
  Span<const Vec3> local;
  Span<const Pose> body;
  Real step;
  Span<Vec3> to;
  TAPE_HD void operator()(int v) const {
    const VertexOwner o = paths.owner[v];
    if (o.block < 0) return;
    to[v] = o.body < 0 ? paths[v].at(step) : apply(body[o.body], local[v]);
  }
};
struct MoveCoordinate {
  Span<const Vec3> from, direction;
  int first_block;
  Real step;
  Span<Vec3> to;
  TAPE_HD void operator()(int k) const { to[k] = from[k] + step * direction[first_block + k]; }
};
struct BlockPoints {
  Span<const Vec3> x;
  Span<const VertexOwner> owner;
  Span<Vec3> points;
  TAPE_HD void operator()(int v) const {
    if (owner[v].block >= 0 && owner[v].body < 0) points[owner[v].block] = x[v];
  }
};
}  // namespace coordinates

/// What moves the vertices, as long as no cluster loses a member.
class Coordinates {
 public:
  /// @param owner        [nv]
  /// @param local        [nv] m, in frame B
  /// @param body_block   [bodies] first block of each, -1 if it is fixed
  /// @param body_centre  [bodies] vertex at the centre of mass of each, -1 if it is fixed
  /// @param q_block      first block of the articulations, which are consecutive
  Coordinates(const std::vector<VertexOwner>& owner, const std::vector<Vec3>& local, const std::vector<int>& body_block,
              const std::vector<int>& body_centre, int q_block)
      : owner_(owner), local_(local), body_block_(body_block), body_centre_(body_centre), q_block_(q_block) {}
  Span<const VertexOwner> owner() const { return owner_.span(); }
  /// to = from moved by `step` times the direction [blocks] m and rad. Fixed things keep what `to` has.
  void move(const Configuration& from, Span<const Vec3> direction, Real step, Configuration& to) const {
    parallel_for(from.q.size(), coordinates::MoveCoordinate{from.q.span(), direction, q_block_, step, to.q.span()});
    const PathView along = paths(from, direction);
    parallel_for(from.body.size(), coordinates::MoveBody{along, body_block_.span(), body_centre_.span(), step, to.body.span()});
    parallel_for(from.x.size(), coordinates::MoveVertex{along, local_.span(), to.body.span(), step, to.x.span()});
  }
  /// points[block] = position [m] of the vertex that is this block. Blocks of bodies keep what `points` [blocks] has.
  void block_points(const Configuration& at, Span<Vec3> points) const {
    parallel_for(at.x.size(), coordinates::BlockPoints{at.x.span(), owner_.span(), points});
  }
  PathView paths(const Configuration& from, Span<const Vec3> direction) const {
    return {from.x.span(), owner_.span(), direction, from.body.span()};
  }

 private:
  Buffer<VertexOwner> owner_;
  Buffer<Vec3> local_;
  Buffer<int> body_block_, body_centre_;
  int q_block_;
};
}  // namespace tape::TAPE_SIDE
