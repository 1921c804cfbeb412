#pragma once
#include <string>
#include <vector>

#include "tape/core/settings.hpp"
#include "tape/math/plane.hpp"
#include "tape/model/strip_mesh.hpp"

namespace tape {
/// A point of a strip, by the triangle that it is in.
struct Place {
  int triangle = -1;
  Vec3 weight = Vec3::Constant(-1e30);  ///< barycentric
  /// Up to rounding, measured in the size of the triangle.
  bool inside() const { return weight.minCoeff() >= -1e-9; }
};

/// Corners [m] of a triangle in the rest plane.
struct Corners {
  const Vec2 &a, &b, &c;
  Real area() const { return turn(a, b, c) / 2; }
  Vec2 centre() const { return (a + b + c) / 3; }
  Vec3 weight(const Vec2& p) const { return barycentric(p, a, b, c); }
  Real angle() const { return smallest_angle(a, b, c); }
  Real longest_edge() const { return std::max({(b - a).norm(), (c - b).norm(), (a - c).norm()}); }
  Real shortest_edge() const { return std::min({(b - a).norm(), (c - b).norm(), (a - c).norm()}); }
};
inline Corners corners(const StripMesh& mesh, int triangle) {
  const Index3& v = mesh.triangles[triangle];
  return {mesh.rest[v[0]], mesh.rest[v[1]], mesh.rest[v[2]]};
}

/// The first of `triangles` that p [m] is deepest in, or least far outside of.
inline Place locate(const StripMesh& mesh, const std::vector<int>& triangles, const Vec2& p) {
  Place best;
  for (int t : triangles)
    if (const Vec3 weight = corners(mesh, t).weight(p); weight.minCoeff() > best.weight.minCoeff()) best = {t, weight};
  return best;
}

/// For messages: a length in whole micrometres, and a point.
inline std::string length_text(Real metres) { return to_text(std::round(metres * 1e6) / 1e3) + " mm"; }
inline std::string point_text(const Vec2& p) { return "[" + length_text(p.x()) + ", " + length_text(p.y()) + "]"; }
}  // namespace tape
