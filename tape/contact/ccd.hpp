#pragma once
#include <algorithm>
#include <cmath>
#include <limits>

#include "tape/bodies/path.hpp"
#include "tape/contact/pair.hpp"

namespace tape {
/// How far a pair may go along its trial step.
struct PairStep {
  Real t;       ///< [1] in [0, 1]; exactly 1 where nothing comes close
  bool capped;  ///< the iterations ran out: t is safe but short
};
struct CcdSettings {
  Real eta = 0.2;        ///< [1] share of the gap at the start that is kept, in (0, 1)
  int iterations = 512;  ///< cap on the number of advances
};

namespace detail {
/// Largest tau with a + b s - c s^2 / 2 >= 0 for all s in [0, tau]; a >= 0, c >= 0. Infinite if there is none.
TAPE_HD inline Real first_zero(Real a, Real b, Real c) {
  if (c == 0) return b < 0 ? -a / b : std::numeric_limits<Real>::infinity();
  const Real root = std::sqrt(b * b + 2 * a * c);
  if (b > 0) return (b + root) / c;
  return root - b > 0 ? 2 * a / (root - b) : 0.0;
}

/// Whether four paths turn about one body: tape on its roll, which is seen from a frame that turns with the first.
TAPE_HD inline bool turn_together(const VertexPath (&path)[4]) {
  bool together = !path[0].straight();
  for (int i = 1; i < 4; ++i) together = together && path[i].centre == path[0].centre && !path[i].straight();
  return together;
}
/// Where four paths stand at one time, relative to the start of the first and seen from its drift, and how they go on. Distances are the
/// same from a frame that turns, in which with its spin w and e = spin - w, a path of drift u, exp(t w) y = t u + exp(t spin) arm, has
///   |y''| <= |w| (2 + |w|) |u| + |e| (|e| + |w|) |arm|   for t in [0, 1].
struct Motion {
  Vec3 x[4], velocity[4];  ///< [m], [m] per whole step
  Real bend[4];            ///< [m] bound of the acceleration, per whole step squared
};
TAPE_HD inline Motion motion_at(const VertexPath (&path)[4], Real t) {
  const auto turned = [t](const Vec3& spin, const Vec3& r) { return t == 0 ? r : rotate(t * spin, r); };  // most pairs take one look
  Motion m;
  if (turn_together(path)) {
    const Vec3 w = path[0].spin;
    for (int i = 0; i < 4; ++i) {
      const VertexPath& p = path[i];
      const Vec3 drift = p.velocity - path[0].velocity, apart = p.spin - w, arm = turned(p.spin, p.arm);
      m.x[i] = turned(-w, t * drift + arm);
      m.velocity[i] = turned(-w, drift - w.cross(t * drift) + apart.cross(arm));
      m.bend[i] = w.norm() * (2 + w.norm()) * drift.norm() + apart.norm() * (apart.norm() + w.norm()) * p.arm.norm();
    }
    return m;
  }
  for (int i = 0; i < 4; ++i) {
    const VertexPath& p = path[i];
    const Vec3 start = p.centre - path[0].centre;
    m.velocity[i] = p.velocity - path[0].velocity;
    m.bend[i] = 0;
    if (p.straight()) {
      m.x[i] = (start + p.arm) + t * m.velocity[i];
      continue;
    }
    const Vec3 arm = turned(p.spin, p.arm), swing = p.spin.cross(arm);
    m.x[i] = (start + arm) + t * m.velocity[i];
    m.velocity[i] += swing;
    m.bend[i] = p.spin.norm() * swing.norm();
  }
  return m;
}
/// Bound of the error [m] of n . (x_i - x_j) at time t, n a unit vector.
TAPE_HD inline Real round_off(const VertexPath (&path)[4], Real t) {
  Real size = 0;
  for (int i = 0; i < 4; ++i) {
    const VertexPath& p = path[i];
    size += (p.centre - path[0].centre).cwiseAbs().sum() + p.arm.cwiseAbs().sum() + t * (p.velocity - path[0].velocity).cwiseAbs().sum();
  }
  return 16 * std::numeric_limits<Real>::epsilon() * size;
}
/// Unit vector along the offset between closest points, `along`. Between a face and a vertex or two edges it is the common normal; its
/// product with edges of metres then is zero to round-off, while that of the offset carries the error of the closest points.
TAPE_HD inline Vec3 separating_direction(PairKind kind, const Vec3 (&x)[4], const Closest& c, const Vec3& along) {
  if (c.free < 2) return along;
  const bool vertex = kind == PairKind::vertex_triangle;
  const Vec3 a = vertex ? x[2] - x[1] : x[1] - x[0], b = vertex ? x[3] - x[1] : x[3] - x[2], n = a.cross(b);
  const Real length2 = n.squaredNorm();
  if (!(length2 > 1e-12 * a.squaredNorm() * b.squaredNorm())) return along;
  return n / (n.dot(along) > 0 ? std::sqrt(length2) : -std::sqrt(length2));
}
TAPE_HD inline bool at_rest(const Motion& m) {
  for (int i = 0; i < 4; ++i)
    if (!m.velocity[i].isZero(0) || m.bend[i] > 0) return false;
  return true;
}
}  // namespace detail

/// Largest step t for which the gap d - xi of a pair stays above eta times its start over all of [0, t].
/// Conservative advancement with a separating direction: with n the direction between the closest points at t, every later distance is
/// at least min over vertex pairs of n . (x_i - x_j), and along true paths each of these falls no faster than
///   a + b s - c s^2 / 2,   b = n . (x_i' - x_j'),   c = |spin_i|^2 r_i + |spin_j|^2 r_j   (r: distance from the axis).
/// The bound holds for any unit vector n, so an inexact closest point costs iterations, never a missed contact; for straight motion
/// it is never shorter than the additive advance (d - xi) / l_p of [Li 2021] and does not stall in sliding. Derivation: README.md.
/// A pair that starts without a gap may open or keep still: anything else has t = 0.
TAPE_HD inline PairStep largest_step(PairKind kind, const VertexPath (&path)[4], Real xi, const CcdSettings& settings) {
  constexpr Real kUsed = 0.99;      // of each safe advance, so that the check of a step just taken passes despite round-off
  constexpr Real kTolerance = 0.1;  // stop when the gap is within this share of the smallest one allowed
  const bool vertex = kind == PairKind::vertex_triangle;
  Real t = 0, kept = 0;
  for (int k = 0; k < settings.iterations; ++k) {
    const detail::Motion m = detail::motion_at(path, t);
    if (k == 0 && detail::at_rest(m)) return {1, false};
    const Closest c = closest(kind, m.x);
    const Vec3 p = combine(c.weight, m.x);
    const Real d = p.norm();
    if (!(d > 0)) return {t, false};
    const Vec3 n = detail::separating_direction(kind, m.x, c, p / d);
    Real height[4], rate[4];  // of the vertices along n: the first primitive stands above the second
    for (int i = 0; i < 4; ++i) height[i] = n.dot(m.x[i]), rate[i] = n.dot(m.velocity[i]);
    const Real taken = xi + detail::round_off(path, t);
    const Real low = vertex ? height[0] : std::min(height[0], height[1]);
    const Real high = vertex ? std::max(height[1], std::max(height[2], height[3])) : std::max(height[2], height[3]);
    const Real gap = low - high - taken;
    if (k == 0) kept = gap > 0 ? settings.eta * gap : gap;
    if (k > 0 && !(gap > (1 + kTolerance) * kept)) return {t, false};
    const Real rest = 1 - t;
    Real safe = rest;
    bool arrives = true;
    for (int i = 0; i < (vertex ? 1 : 2); ++i)
      for (int j = vertex ? 1 : 2; j < 4; ++j) {
        const Real spare = std::max(0.0, height[i] - height[j] - taken - kept), approach = rate[i] - rate[j], bend = m.bend[i] + m.bend[j];
        if (spare + rest * (approach - 0.5 * bend * rest) >= 0) continue;  // a concave bound that is positive at both ends
        arrives = false;
        safe = std::min(safe, detail::first_zero(spare, approach, bend));
      }
    if (arrives) return {1, false};
    if (!(gap > 0)) return {t, false};
    t += kUsed * safe;
  }
  return {t, true};
}
}  // namespace tape
