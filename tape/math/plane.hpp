#pragma once
#include <algorithm>
#include <cmath>

#include "tape/core/types.hpp"

/// Points, segments and triangles of a plane.
namespace tape {
inline Real cross(const Vec2& a, const Vec2& b) { return a.x() * b.y() - a.y() * b.x(); }

/// Twice the signed area [m^2] of a triangle: positive if counter-clockwise.
inline Real turn(const Vec2& a, const Vec2& b, const Vec2& c) { return cross(b - a, c - a); }

inline Vec2 left_of(const Vec2& direction) { return {-direction.y(), direction.x()}; }

/// Weights of the corners that give p; their sum is 1, and none is negative inside. Assumes that the triangle has an area.
inline Vec3 barycentric(const Vec2& p, const Vec2& a, const Vec2& b, const Vec2& c) {
  const Real whole = turn(a, b, c), at_b = turn(a, p, c) / whole, at_c = turn(a, b, p) / whole;
  return {1 - at_b - at_c, at_b, at_c};
}

/// Distance [m] of p from the segment a-b.
inline Real distance_to_segment(const Vec2& p, const Vec2& a, const Vec2& b) {
  const Vec2 along = b - a, from = p - a;
  const Real length2 = along.squaredNorm(), at = length2 > 0 ? std::clamp(from.dot(along) / length2, 0.0, 1.0) : 0.0;
  return (from - at * along).norm();
}

/// Angle [rad] at corner a of a triangle.
inline Real angle_at(const Vec2& a, const Vec2& b, const Vec2& c) { return std::atan2(std::fabs(turn(a, b, c)), (b - a).dot(c - a)); }
inline Real smallest_angle(const Vec2& a, const Vec2& b, const Vec2& c) {
  return std::min({angle_at(a, b, c), angle_at(b, c, a), angle_at(c, a, b)});
}
}  // namespace tape
