#include "tape/model/primitives.hpp"

#include <cmath>
#include <map>
#include <numbers>
#include <utility>

namespace tape {
namespace {
constexpr Real kPi = std::numbers::pi;

/// Adds a rectangular grid of cells: corner + u (along) + v (across), normal u x v. Vertices on shared edges are not yet shared.
void add_grid(TriangleMesh& mesh, const Vec3& corner, const Vec3& u, const Vec3& v, int nu, int nv) {
  const int first = static_cast<int>(mesh.vertices.size());
  for (int i = 0; i <= nu; ++i)
    for (int j = 0; j <= nv; ++j) mesh.vertices.push_back(corner + u * (static_cast<Real>(i) / nu) + v * (static_cast<Real>(j) / nv));
  for (int i = 0; i < nu; ++i)
    for (int j = 0; j < nv; ++j) {
      const int a = first + i * (nv + 1) + j, b = a + nv + 1;
      mesh.triangles.push_back({a, b, b + 1});
      mesh.triangles.push_back({a, b + 1, a + 1});
    }
}

/// Surface of revolution about z. @param profile  (r, z), with the outside to the right of its direction; r = 0 only at its ends,
/// which are then poles. @param ring  joins the last point to the first.
TriangleMesh revolve(const std::vector<Vec2>& profile, int segments, bool ring) {
  TriangleMesh mesh;
  std::vector<int> first;  // vertex of each profile point at angle 0
  const auto pole = [&](std::size_t i) { return profile[i].x() == 0; };
  for (std::size_t i = 0; i < profile.size(); ++i) {
    first.push_back(static_cast<int>(mesh.vertices.size()));
    for (int k = 0; k < (pole(i) ? 1 : segments); ++k) {
      const Real angle = 2 * kPi * k / segments;
      mesh.vertices.push_back({profile[i].x() * std::cos(angle), profile[i].x() * std::sin(angle), profile[i].y()});
    }
  }
  for (std::size_t i = 0; i + 1 < profile.size() + (ring ? 1 : 0); ++i) {
    const std::size_t j = (i + 1) % profile.size();
    const auto at = [&](std::size_t p, int k) { return first[p] + (pole(p) ? 0 : k % segments); };
    for (int k = 0; k < segments; ++k) {
      if (!pole(i)) mesh.triangles.push_back({at(i, k), at(i, k + 1), at(j, k + 1)});
      if (!pole(j)) mesh.triangles.push_back({at(i, k), at(j, k + 1), at(j, k)});
    }
  }
  return mesh;
}

void add_wall(std::vector<Vec2>& profile, Real radius, Real from, Real to, int bands) {
  for (int b = 0; b <= bands; ++b) profile.push_back({radius, from + (to - from) * b / bands});
}
}  // namespace

TriangleMesh box_mesh(const Vec3& size, const Index3& cells) {
  TriangleMesh faces;
  for (int axis = 0; axis < 3; ++axis)
    for (Real side : {-0.5, 0.5}) {
      const int a = (axis + 1) % 3, b = (axis + 2) % 3;
      const Vec3 u = Vec3::Unit(a) * size[a], v = Vec3::Unit(b) * size[b];
      const Vec3 corner = Vec3::Unit(axis) * size[axis] * side - (u + v) / 2;
      side > 0 ? add_grid(faces, corner, u, v, cells[a], cells[b]) : add_grid(faces, corner, v, u, cells[b], cells[a]);
    }
  return merge_vertices(faces);
}

TriangleMesh cylinder_mesh(Real radius, Real height, int segments, int bands) {
  std::vector<Vec2> profile{{0, -height / 2}};
  add_wall(profile, radius, -height / 2, height / 2, bands);
  profile.push_back({0, height / 2});
  return revolve(profile, segments, false);
}

TriangleMesh ring_mesh(Real inner_radius, Real outer_radius, Real height, int segments, int bands) {
  std::vector<Vec2> profile;
  add_wall(profile, outer_radius, -height / 2, height / 2, bands);
  add_wall(profile, inner_radius, height / 2, -height / 2, bands);
  return revolve(profile, segments, true);
}

TriangleMesh sphere_mesh(Real radius, int subdivisions) {
  const Real g = std::numbers::phi;
  TriangleMesh mesh{{{-1, g, 0},
                     {1, g, 0},
                     {-1, -g, 0},
                     {1, -g, 0},
                     {0, -1, g},
                     {0, 1, g},
                     {0, -1, -g},
                     {0, 1, -g},
                     {g, 0, -1},
                     {g, 0, 1},
                     {-g, 0, -1},
                     {-g, 0, 1}},
                    {{0, 11, 5}, {0, 5, 1}, {0, 1, 7}, {0, 7, 10}, {0, 10, 11}, {1, 5, 9}, {5, 11, 4}, {11, 10, 2}, {10, 7, 6}, {7, 1, 8},
                     {3, 9, 4},  {3, 4, 2}, {3, 2, 6}, {3, 6, 8},  {3, 8, 9},   {4, 9, 5}, {2, 4, 11}, {6, 2, 10},  {8, 6, 7},  {9, 8, 1}}};
  for (int s = 0; s < subdivisions; ++s) {
    std::map<std::pair<int, int>, int> middles;
    const auto middle = [&](int a, int b) {
      const auto [it, added] = middles.try_emplace(std::minmax(a, b), static_cast<int>(mesh.vertices.size()));
      if (added) mesh.vertices.push_back((mesh.vertices[a] + mesh.vertices[b]).normalized());
      return it->second;
    };
    std::vector<Index3> split;
    for (Vec3& v : mesh.vertices) v.normalize();
    for (const Index3& t : mesh.triangles) {
      const int a = middle(t[0], t[1]), b = middle(t[1], t[2]), c = middle(t[2], t[0]);
      split.insert(split.end(), {{t[0], a, c}, {t[1], b, a}, {t[2], c, b}, {a, b, c}});
    }
    mesh.triangles = std::move(split);
  }
  for (Vec3& v : mesh.vertices) v = radius * v.normalized();
  return mesh;
}

TriangleMesh capsule_mesh(Real radius, Real height, int segments) {
  const int rings = std::max(2, segments / 4);
  std::vector<Vec2> profile{{0, -height / 2 - radius}};
  for (int i = 1; i <= rings; ++i) {
    const Real angle = kPi / 2 * i / rings;
    profile.push_back({radius * std::sin(angle), -height / 2 - radius * std::cos(angle)});
  }
  for (int i = rings; i >= 1; --i) {
    const Real angle = kPi / 2 * i / rings;
    profile.push_back({radius * std::sin(angle), height / 2 + radius * std::cos(angle)});
  }
  profile.push_back({0, height / 2 + radius});
  return revolve(profile, segments, false);
}

TriangleMesh sheet_mesh(const Vec2& size, const Index2& cells) {
  TriangleMesh mesh;
  add_grid(mesh, {-size.x() / 2, -size.y() / 2, 0}, Vec3::UnitX() * size.x(), Vec3::UnitY() * size.y(), cells.x(), cells.y());
  return mesh;
}

TriangleMesh wedge_mesh(const Vec3& size) {
  const Real x = size.x() / 2, y = size.y() / 2, z = size.z();
  return {{{-x, -y, 0}, {x, -y, 0}, {x, y, 0}, {-x, y, 0}, {0, -y, z}, {0, y, z}},
          {{0, 2, 1}, {0, 3, 2}, {0, 1, 4}, {2, 3, 5}, {1, 2, 5}, {1, 5, 4}, {3, 0, 4}, {3, 4, 5}}};
}

TriangleMesh spike_mesh(Real radius, Real height, int segments) { return revolve({{0, 0}, {radius, 0}, {0, height}}, segments, false); }
}  // namespace tape
