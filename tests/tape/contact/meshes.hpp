#pragma once
#include <functional>
#include <random>
#include <string>
#include <vector>

#include "tape/contact/surface.hpp"

/// Surfaces for the contact tests and benchmarks.
namespace tape::test {
struct Surface {
  SurfaceMesh mesh;
  std::vector<Vec3> x;  ///< [nv] m
  int blocks = 0;
};

/// Adds an object of triangles whose vertices are `owner` or, if that is null, unknowns of their own.
inline void add_object(Surface& s, const std::vector<Vec3>& x, const std::vector<Index3>& triangles, Real xi,
                       const VertexOwner* owner = nullptr, int material = 0) {
  std::vector<VertexOwner> owners;
  for (const Vec3& p : x) {
    s.x.push_back(p);
    owners.push_back(owner ? *owner : VertexOwner{s.blocks++, -1});
  }
  s.mesh.add_object("object " + std::to_string(s.mesh.objects.size()), x, owners, triangles, xi, material);
}

/// Strip of rows of `columns` vertices with cells of `cell` [m], same diagonals, whose centre line is curve(arc length) in the
/// x-y plane; the width lies along z.
inline void add_strip(Surface& s, int rows, int columns, Real cell, Real xi, const std::function<Vec2(int)>& curve) {
  std::vector<Vec3> x;
  std::vector<Index3> triangles;
  for (int r = 0; r < rows; ++r)
    for (int c = 0; c < columns; ++c) x.emplace_back(curve(r).x(), curve(r).y(), cell * c);
  for (int r = 0; r + 1 < rows; ++r)
    for (int c = 0; c + 1 < columns; ++c) {
      const int a = r * columns + c, b = a + columns;
      triangles.emplace_back(a, b, b + 1);
      triangles.emplace_back(a, b + 1, a + 1);
    }
  add_object(s, x, triangles, xi);
}

/// Points at equal arc length `cell` [m] on the spiral r = inner + pitch angle / 2 pi.
inline std::vector<Vec2> spiral(Real turns, Real inner, Real pitch, Real cell) {
  const Real two_pi = 2 * 3.14159265358979323846, slope = pitch / two_pi;
  std::vector<Vec2> points;
  for (Real angle = 0; angle <= turns * two_pi;) {
    const Real r = inner + slope * angle;
    points.emplace_back(r * std::cos(angle), r * std::sin(angle));
    const Real middle = r + slope * 0.5 * cell / r;
    angle += cell / std::hypot(middle, slope);
  }
  return points;
}
/// A wound strip as in the paper: rows of 7 vertices.
inline Surface wound_strip(Real turns, Real pitch, Real xi, Real cell = 19e-3 / 6) {
  Surface s;
  const std::vector<Vec2> line = spiral(turns, 21.1e-3, pitch, cell);
  add_strip(s, static_cast<int>(line.size()), 7, cell, xi, [&](int r) { return line[static_cast<std::size_t>(r)]; });
  return s;
}
/// A strip folded to and fro in flat layers `pitch` apart, each of `layer_rows` rows, joined by half circles' end points.
inline Surface folded_strip(int layers, int layer_rows, Real pitch, Real xi, Real cell = 19e-3 / 6) {
  Surface s;
  add_strip(s, layers * layer_rows, 7, cell, xi, [&](int r) {
    const int layer = r / layer_rows, k = r % layer_rows;
    return Vec2(cell * (layer % 2 == 0 ? k : layer_rows - 1 - k), pitch * layer);
  });
  return s;
}
/// Triangles of size `size` [m] scattered in a cube of side 1 m, each an object of its own.
inline Surface scattered_triangles(int n, Real size, Real xi, unsigned seed) {
  std::mt19937_64 generator(seed);
  std::uniform_real_distribution<Real> place(0, 1), shape(-size, size);
  Surface s;
  for (int i = 0; i < n; ++i) {
    const Vec3 at(place(generator), place(generator), place(generator));
    std::vector<Vec3> x;
    for (int k = 0; k < 3; ++k) x.push_back(at + Vec3(shape(generator), shape(generator), shape(generator)));
    add_object(s, x, {{0, 1, 2}}, xi);
  }
  return s;
}
}  // namespace tape::test
