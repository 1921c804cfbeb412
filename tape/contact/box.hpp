#pragma once
#include <cfloat>
#include <cmath>

#include "tape/bodies/path.hpp"
#include "tape/core/types.hpp"

namespace tape {
/// Axis-aligned box [m].
struct Box {
  Vec3 low, high;
  TAPE_HD Vec3 centre() const { return 0.5 * (low + high); }
  TAPE_HD Real radius() const { return 0.5 * (high - low).norm(); }  ///< [m] no point of the box is farther from the centre
  TAPE_HD bool contains(const Box& b) const {
    for (int k = 0; k < 3; ++k)
      if (!(low[k] <= b.low[k] && b.high[k] <= high[k])) return false;
    return true;
  }
};
TAPE_HD inline bool meet(const Box& a, const Box& b) {
  return (a.low.array() <= b.high.array()).all() && (b.low.array() <= a.high.array()).all();
}
TAPE_HD inline Box inflated(const Box& b, Real by) { return {b.low - Vec3::Constant(by), b.high + Vec3::Constant(by)}; }
TAPE_HD inline Box joined(const Box& a, const Box& b) { return {a.low.cwiseMin(b.low), a.high.cwiseMax(b.high)}; }

/// Holds the whole path, t in [0, 1]: the box of its ends, inflated for an arc by the largest distance from its chord.
TAPE_HD inline Box path_box(const VertexPath& path) {
  const Vec3 x0 = path.centre + path.arm, x1 = path.at(1);
  Box chord{x0.cwiseMin(x1), x0.cwiseMax(x1)};
  if (path.straight()) return chord;
  const Real angle = path.spin.norm();
  return inflated(chord, chord_deviation(path.spin.cross(path.arm).norm() / angle, angle));
}

/// A frame over a trial step. In its coordinates, which are those of the world wherever it last found itself at `origin`, a point x is at
///   y(t) = origin + turn exp(-t spin) (x - centre - t velocity).
struct FramePath {
  Vec3 centre, velocity, spin;  ///< [m], [m] and [rad] per whole step
  Mat3 turn;                    ///< what its rotation was at `origin`, times the inverse of what it is now
  Vec3 origin;                  ///< [m]
};
/// Holds the whole path seen from the frame: the box of its ends, inflated by an eighth of a bound of |y''|, which a chord cannot miss by
/// more. With r = centre + t velocity of the path seen from the frame's, a its arm and e = spin of the path - spin of the frame =: w,
///   exp(t w) y'' = turn (w x (w x r - 2 r') + (e x w) x a + e x (e x a)),
/// whose first term is affine in t.
TAPE_HD inline Box path_box(const FramePath& frame, const VertexPath& path) {
  const Vec3 r = path.centre - frame.centre, drift = path.velocity - frame.velocity, w = frame.spin, e = path.spin - w;
  const Vec3 y0 = frame.origin + frame.turn * (r + path.arm);
  const Vec3 y1 = frame.origin + frame.turn * rotate(-w, path.at(1) - frame.centre - frame.velocity);
  const Real swing = std::fmax(w.cross(w.cross(r) - 2 * drift).norm(), w.cross(w.cross(r + drift) - 2 * drift).norm());
  const Real bend = swing + (e.cross(w).norm() + e.squaredNorm()) * path.arm.norm();
  return inflated({y0.cwiseMin(y1), y0.cwiseMax(y1)}, bend / 8);
}

/// A box as the tree stores it: eight numbers that are merged by their minimum and compared as a whole.
/// Lanes 0-2 low, 3-5 -high [m, rounded outwards], 6 -(largest id), 7 whether no part of it can move.
struct alignas(32) Lanes {
  float m[8];
};

namespace detail {
TAPE_HD inline float rounded_down(Real value) {
  const float f = static_cast<float>(value);
  return f - (std::fabs(f) * FLT_EPSILON + FLT_MIN);  // by an ulp or two: nextafter takes a twentieth of a step in a scene with robots
}
using LanesMap = Eigen::Map<Eigen::Array<float, 8, 1>>;
using ConstLanesMap = Eigen::Map<const Eigen::Array<float, 8, 1>>;
}  // namespace detail

/// @param id     below 2^24, so that a float holds it
/// @param fixed  nothing in the box can move
TAPE_HD inline Lanes stored_box(const Box& b, int id, bool fixed) {
  Lanes out;
  for (int k = 0; k < 3; ++k) {
    out.m[k] = detail::rounded_down(b.low[k]);
    out.m[3 + k] = detail::rounded_down(-b.high[k]);
  }
  out.m[6] = -static_cast<float>(id);
  out.m[7] = fixed ? 1.0f : 0.0f;
  return out;
}
/// Meets no box.
TAPE_HD inline Lanes empty_box() {
  Lanes out;
  for (float& m : out.m) m = FLT_MAX / 2;
  return out;
}
/// What stored boxes are compared with: meets those that overlap `b` and hold an id >= first_id; a fixed query, only those that can move.
TAPE_HD inline Lanes query_box(const Box& b, int first_id, bool fixed) {
  Lanes out;
  for (int k = 0; k < 3; ++k) {
    out.m[k] = -detail::rounded_down(-b.high[k]);
    out.m[3 + k] = -detail::rounded_down(b.low[k]);
  }
  out.m[6] = -static_cast<float>(first_id);
  out.m[7] = fixed ? 0.0f : 1.0f;
  return out;
}
/// Meets no box either, as a query.
TAPE_HD inline Lanes empty_query() {
  Lanes out;
  for (float& m : out.m) m = -FLT_MAX / 2;
  return out;
}
TAPE_HD inline Lanes merged(const Lanes& a, const Lanes& b) {
  Lanes out;
  detail::LanesMap(out.m) = detail::ConstLanesMap(a.m).min(detail::ConstLanesMap(b.m));
  return out;
}

/// Eight stored boxes that are compared with a query together: lane by lane, eight boxes wide.
struct alignas(32) LanesOf8 {
  float m[8][8];  ///< [lane][box]
  TAPE_HD void set(int box, const Lanes& b) {
    for (int lane = 0; lane < 8; ++lane) m[lane][box] = b.m[lane];
  }
  TAPE_HD Lanes all() const {
    Lanes out;
    for (int lane = 0; lane < 8; ++lane) out.m[lane] = detail::ConstLanesMap(m[lane]).minCoeff();
    return out;
  }
  /// Bit k says whether box k meets the query.
  TAPE_HD unsigned met(const Lanes& query) const {
    Eigen::Array<float, 8, 1, Eigen::DontAlign> slack = query.m[0] - detail::ConstLanesMap(m[0]);
    for (int lane = 1; lane < 8; ++lane) slack = slack.min(query.m[lane] - detail::ConstLanesMap(m[lane]));
    unsigned bits = 0;
    for (int box = 0; box < 8; ++box) bits |= static_cast<unsigned>(slack[box] >= 0) << box;
    return bits;
  }
};
}  // namespace tape
