#include "tape/math/predicates.hpp"

#include <gmpxx.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace tape {
namespace {
constexpr Real kEps = std::numeric_limits<Real>::epsilon() / 2;  // Shewchuk's unit: half of an ulp
constexpr Real kTiny = 1e-250;                                   // below this a product may have lost digits to underflow

struct Exact {
  mpq_class x[3];
  explicit Exact(const Vec3& p) : x{mpq_class(p.x()), mpq_class(p.y()), mpq_class(p.z())} {}
};

int exact_orientation(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  const Exact origin(d);
  std::array<Exact, 3> r{Exact(a), Exact(b), Exact(c)};
  for (Exact& e : r)
    for (int k = 0; k < 3; ++k) e.x[k] -= origin.x[k];
  const auto minor = [&](int i, int j) { return mpq_class(r[1].x[i] * r[2].x[j] - r[1].x[j] * r[2].x[i]); };
  const mpq_class det = r[0].x[0] * minor(1, 2) + r[0].x[1] * minor(2, 0) + r[0].x[2] * minor(0, 1);
  return sgn(det);
}

int exact_projected(const Vec3& a, const Vec3& b, const Vec3& c, int i, int j) {
  const Exact ea(a), eb(b), ec(c);
  const mpq_class det = (ea.x[i] - ec.x[i]) * (eb.x[j] - ec.x[j]) - (ea.x[j] - ec.x[j]) * (eb.x[i] - ec.x[i]);
  return sgn(det);
}

int sign(Real value) { return (value > 0) - (value < 0); }

/// Whether p, which lies on the line a-b, is on the segment.
bool within(const Vec3& p, const Vec3& a, const Vec3& b) {
  return (p.array() >= a.array().min(b.array())).all() && (p.array() <= a.array().max(b.array())).all();
}

/// An axis along which the plane of the points, which all lie in one, projects one to one; -1 if they lie on a line.
template <std::size_t N>
int good_axis(const std::array<Vec3, N>& x) {
  for (int axis = 0; axis < 3; ++axis)
    for (std::size_t i = 0; i < N; ++i)
      for (std::size_t j = i + 1; j < N; ++j)
        for (std::size_t k = j + 1; k < N; ++k)
          if (projected_orientation(x[i], x[j], x[k], axis) != 0) return axis;
  return -1;
}

bool segments_meet(const Vec3& p, const Vec3& q, const Vec3& a, const Vec3& b) {
  if (orientation(p, q, a, b) != 0) return false;
  const int axis = std::max(0, good_axis<4>({p, q, a, b}));
  const int pa = projected_orientation(p, q, a, axis), pb = projected_orientation(p, q, b, axis);
  const int ap = projected_orientation(a, b, p, axis), aq = projected_orientation(a, b, q, axis);
  if (pa * pb < 0 && ap * aq < 0) return true;
  return (pa == 0 && within(a, p, q)) || (pb == 0 && within(b, p, q)) || (ap == 0 && within(p, a, b)) || (aq == 0 && within(q, a, b));
}

/// The segment lies in the plane of the triangle, or the triangle has no area.
bool flat_meet(const Vec3& p, const Vec3& q, const Vec3& a, const Vec3& b, const Vec3& c) {
  if (const int axis = good_axis<3>({a, b, c}); axis >= 0) {
    const int s0 = projected_orientation(a, b, p, axis), s1 = projected_orientation(b, c, p, axis),
              s2 = projected_orientation(c, a, p, axis);
    if (s0 * s1 > 0 && s1 * s2 > 0) return true;  // p is strictly inside; on the rim the segments below see it
  }
  return segments_meet(p, q, a, b) || segments_meet(p, q, b, c) || segments_meet(p, q, c, a);
}
/// Whether a plane across n lies between segment 0-1 and triangle 2-3-4 beyond all doubt: `doubt` bounds the rounding of n . x.
bool separates(const Vec3& n, const std::array<Vec3, 5>& x, Real size) {
  const Real doubt = 32 * kEps * size * n.lpNorm<1>();
  const auto [low, high] = std::minmax({n.dot(x[0]), n.dot(x[1])});
  const auto [below, above] = std::minmax({n.dot(x[2]), n.dot(x[3]), n.dot(x[4])});
  return low > above + doubt || below > high + doubt;
}

/// Decides nearly all pairs that are apart, above all those that lie in one plane, which the orientations could decide only in
/// rationals. Any n gives a true answer.
bool certainly_apart(const Vec3& p, const Vec3& q, const Vec3& a, const Vec3& b, const Vec3& c) {
  const std::array<Vec3, 5> x{p - a, q - a, Vec3::Zero(), b - a, c - a};
  Real size = 0;
  for (const Vec3& r : x) size = std::max(size, r.lpNorm<Eigen::Infinity>());
  const Vec3 normal = x[3].cross(x[4]);
  if (separates(normal, x, size)) return true;
  for (const Vec3& along : {x[3], x[4], Vec3(c - b), Vec3(q - p)})
    if (separates(normal.cross(along), x, size)) return true;
  return false;
}
}  // namespace

int orientation(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  const Vec3 r = a - d, s = b - d, t = c - d;
  const Real st = s.x() * t.y(), ts = s.y() * t.x(), tr = t.x() * r.y(), rt = t.y() * r.x(), rs = r.x() * s.y(), sr = r.y() * s.x();
  const Real det = r.z() * (st - ts) + s.z() * (tr - rt) + t.z() * (rs - sr);
  const Real size = (std::fabs(st) + std::fabs(ts)) * std::fabs(r.z()) + (std::fabs(tr) + std::fabs(rt)) * std::fabs(s.z()) +
                    (std::fabs(rs) + std::fabs(sr)) * std::fabs(t.z());
  constexpr Real kBound = (7 + 56 * kEps) * kEps;
  if (std::isfinite(size) && size > kTiny && std::fabs(det) > kBound * size) return sign(det);
  return exact_orientation(a, b, c, d);
}

int projected_orientation(const Vec3& a, const Vec3& b, const Vec3& c, int axis) {
  const int i = (axis + 1) % 3, j = (axis + 2) % 3;
  const Real left = (a[i] - c[i]) * (b[j] - c[j]), right = (a[j] - c[j]) * (b[i] - c[i]);
  const Real det = left - right, size = std::fabs(left) + std::fabs(right);
  constexpr Real kBound = (3 + 16 * kEps) * kEps;
  if (std::isfinite(size) && size > kTiny && std::fabs(det) > kBound * size) return sign(det);
  return exact_projected(a, b, c, i, j);
}

bool segment_meets_triangle(const Vec3& p, const Vec3& q, const Vec3& a, const Vec3& b, const Vec3& c) {
  if (certainly_apart(p, q, a, b, c)) return false;
  const int sp = orientation(a, b, c, p), sq = orientation(a, b, c, q);
  if (sp * sq > 0) return false;
  if (sp == 0 && sq == 0) return flat_meet(p, q, a, b, c);
  const int s0 = orientation(p, q, a, b), s1 = orientation(p, q, b, c), s2 = orientation(p, q, c, a);
  return (s0 >= 0 && s1 >= 0 && s2 >= 0) || (s0 <= 0 && s1 <= 0 && s2 <= 0);
}
}  // namespace tape
