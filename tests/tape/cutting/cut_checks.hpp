#pragma once
#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <limits>
#include <map>
#include <numbers>
#include <set>
#include <utility>
#include <vector>

#include "tape/cutting/blade_line.hpp"
#include "tape/cutting/kerf.hpp"

/// What must hold of every cut, found without the code that makes it.
namespace tape::test {
inline Real area(const StripMesh& m) {
  Real sum = 0;
  for (const Index3& t : m.triangles) {
    const Vec2 a = m.rest[t[1]] - m.rest[t[0]], b = m.rest[t[2]] - m.rest[t[0]];
    sum += (a.x() * b.y() - a.y() * b.x()) / 2;
  }
  return sum;
}
/// Directed edges that no second triangle has.
inline std::vector<std::pair<int, int>> rim(const StripMesh& m) {
  std::set<std::pair<int, int>> edges;
  for (const Index3& t : m.triangles)
    for (int k = 0; k < 3; ++k) edges.insert({t[k], t[(k + 1) % 3]});
  std::vector<std::pair<int, int>> open;
  for (const auto& [a, b] : edges)
    if (!edges.contains({b, a})) open.push_back({a, b});
  return open;
}
inline std::vector<int> pieces_by_flooding(const StripMesh& m) {
  std::vector<std::vector<int>> neighbours(m.rest.size());
  for (const Index3& t : m.triangles)
    for (int k = 0; k < 3; ++k) neighbours[t[k]].push_back(t[(k + 1) % 3]), neighbours[t[(k + 1) % 3]].push_back(t[k]);
  std::vector<int> piece(m.rest.size(), -1), pending;
  int next = 0;
  for (int start = 0; start < static_cast<int>(piece.size()); ++start) {
    if (piece[start] >= 0) continue;
    pending.push_back(start);
    piece[start] = next;
    while (!pending.empty()) {
      const int v = pending.back();
      pending.pop_back();
      for (int n : neighbours[v])
        if (piece[n] < 0) piece[n] = next, pending.push_back(n);
    }
    ++next;
  }
  return piece;
}
inline Real distance(const Vec2& p, const Vec2& a, const Vec2& b) {
  const Vec2 along = b - a;
  const Real at = std::clamp((p - a).dot(along) / along.squaredNorm(), 0.0, 1.0);
  return (p - a - at * along).norm();
}
/// The line less `by` [m] of its first and last segment: what a flat end is sure to clear. No points if these are shorter.
inline Line shortened(Line line, Real by) {
  const Real needed = line.size() == 2 ? 2 * by : by;
  for (int end = 0; end < 2 && !line.empty(); ++end) {
    const Vec2 along = line[1] - line[0];
    if (along.norm() <= needed - end * (needed - by)) return {};
    line[0] += by * along.normalized();
    std::reverse(line.begin(), line.end());
  }
  return line;
}
/// Distance [m] of the line that was followed from the nearest edge of a triangle, if neither crosses the other.
inline Real distance_from_followed_line(const Cut& cut, const Line& line) {
  Real nearest = std::numeric_limits<Real>::infinity();
  for (const Index3& t : cut.mesh.triangles)
    for (int k = 0; k < 3; ++k) {
      const Vec2 &a = cut.mesh.rest[t[k]], &b = cut.mesh.rest[t[(k + 1) % 3]];
      for (std::size_t i = 0; i + 1 < line.size(); ++i) nearest = std::min(nearest, distance(a, line[i], line[i + 1]));
      for (const Vec2& p : line) nearest = std::min(nearest, distance(p, a, b));
    }
  return nearest;
}
/// Smallest distance [m] of a corner of the rim from a part of the rim that it is not on.
inline Real smallest_gap(const StripMesh& m) {
  Real gap = std::numeric_limits<Real>::infinity();
  const auto edges = rim(m);
  for (const auto& [v, unused] : edges)
    for (const auto& [a, b] : edges)
      if (v != a && v != b) gap = std::min(gap, distance(m.rest[v], m.rest[a], m.rest[b]));
  return gap;
}

inline void expect_a_strip_mesh(const Cut& cut) {
  const StripMesh& m = cut.mesh;
  std::set<std::pair<int, int>> edges;
  std::vector<char> used(m.rest.size(), 0);
  int widest = 1;
  for (const Index3& t : m.triangles) {
    for (int k = 0; k < 3; ++k) {
      used[t[k]] = 1;
      EXPECT_TRUE(edges.insert({t[k], t[(k + 1) % 3]}).second) << "an edge has two triangles on one side";
    }
    widest = std::max(widest, t.maxCoeff() - t.minCoeff());
  }
  EXPECT_EQ(std::count(used.begin(), used.end(), 0), 0) << "vertices without triangles";
  EXPECT_EQ(m.columns, widest);
  EXPECT_GE(m.rows * m.columns, static_cast<int>(m.rest.size()));
  for (std::size_t v = 1; v < m.rest.size(); ++v) {
    const std::pair before(m.rest[v - 1].x(), m.rest[v - 1].y()), here(m.rest[v].x(), m.rest[v].y());
    EXPECT_LT(before, here) << "vertices are not numbered by x";
  }
  std::set<int> starts;
  for (const auto& [a, b] : rim(m)) EXPECT_TRUE(starts.insert(a).second) << "two rims meet at a vertex";
  EXPECT_EQ(cut.piece, pieces_by_flooding(m));
  EXPECT_EQ(cut.pieces, *std::max_element(cut.piece.begin(), cut.piece.end()) + 1);
}

/// @param angle  [deg] that new triangles must keep
inline void expect_quality(const StripMesh& old, const Cut& cut, Real width, Real angle) {
  const Real cell = std::sqrt(2 * area(old) / static_cast<Real>(old.triangles.size()));
  for (std::size_t t = static_cast<std::size_t>(cut.unchanged); t < cut.mesh.triangles.size(); ++t)
    for (int k = 0; k < 3; ++k) {
      const Index3& v = cut.mesh.triangles[t];
      const Vec2 a = cut.mesh.rest[v[(k + 1) % 3]] - cut.mesh.rest[v[k]], b = cut.mesh.rest[v[(k + 2) % 3]] - cut.mesh.rest[v[k]];
      EXPECT_GE(std::atan2(a.x() * b.y() - a.y() * b.x(), a.dot(b)) * 180 / std::numbers::pi, angle);
      EXPECT_GE(a.norm(), std::min(0.05 * cell, 0.9 * width));
    }
}

/// @param reach  [m] from the line; farther triangles must be as they were
inline void expect_the_rest_unchanged(const StripMesh& old, const Cut& cut, const Line& line, Real reach) {
  int same = 0;
  for (std::size_t t = 0; t < old.triangles.size(); ++t) {
    Real nearest = std::numeric_limits<Real>::infinity();
    for (int v : old.triangles[t])
      for (std::size_t i = 0; i + 1 < line.size(); ++i) nearest = std::min(nearest, distance(old.rest[v], line[i], line[i + 1]));
    const int now = cut.new_triangle[t];
    EXPECT_TRUE(now >= 0 || nearest <= reach) << "a triangle " << nearest << " m from the line was taken";
    if (now < 0) continue;
    EXPECT_EQ(now, same++) << "triangles that stay keep their order";
    EXPECT_EQ(cut.source[now], static_cast<int>(t));
    for (int k = 0; k < 3; ++k) {
      EXPECT_EQ(cut.mesh.triangles[now][k], cut.new_vertex[old.triangles[t][k]]);
      EXPECT_EQ(cut.mesh.rest[cut.mesh.triangles[now][k]], old.rest[old.triangles[t][k]]);
    }
  }
  EXPECT_EQ(same, cut.unchanged);
}

inline void expect_true_parents(const StripMesh& old, const Cut& cut) {
  ASSERT_EQ(cut.parent.size(), cut.mesh.rest.size());
  std::vector<char> survives(cut.mesh.rest.size(), 0);
  for (std::size_t v = 0; v < old.rest.size(); ++v) {
    const int now = cut.new_vertex[v];
    if (now < 0) continue;
    survives[now] = 1;
    EXPECT_EQ(cut.mesh.rest[now], old.rest[v]);
    const Place& p = cut.parent[now];
    int k = 0;
    EXPECT_EQ(p.weight.maxCoeff(&k), 1);
    EXPECT_EQ(p.weight.cwiseAbs().sum(), 1);
    EXPECT_EQ(old.triangles[p.triangle][k], static_cast<int>(v));
  }
  const auto point = [&](const Place& p) -> Vec2 {
    const Index3& t = old.triangles[p.triangle];
    return p.weight[0] * old.rest[t[0]] + p.weight[1] * old.rest[t[1]] + p.weight[2] * old.rest[t[2]];
  };
  for (std::size_t v = 0; v < cut.parent.size(); ++v) {
    EXPECT_LT((point(cut.parent[v]) - cut.mesh.rest[v]).norm(), 1e-15);
    EXPECT_GE(cut.parent[v].weight.minCoeff(), 0);
  }
  for (std::size_t t = 0; t < cut.mesh.triangles.size(); ++t) {  // the centroid is on the left of the edges of its source
    const Index3 &now = cut.mesh.triangles[t], &then = old.triangles[cut.source[t]];
    const Vec2 centre = (cut.mesh.rest[now[0]] + cut.mesh.rest[now[1]] + cut.mesh.rest[now[2]]) / 3;
    for (int k = 0; k < 3; ++k) {
      const Vec2 edge = old.rest[then[(k + 1) % 3]] - old.rest[then[k]], to = centre - old.rest[then[k]];
      EXPECT_GT(edge.x() * to.y() - edge.y() * to.x(), -1e-15);
    }
  }
}

/// @param angle  [deg] that new triangles must keep
inline void expect_sound(const StripMesh& old, const Cut& cut, const Line& line, Real width, Real angle = 15) {
  ASSERT_EQ(cut.refusal, "");
  EXPECT_NEAR(area(cut.mesh) + cut.kerf_area, area(old), 1e-12 * area(old));
  EXPECT_GT(cut.kerf_area, 0);
  expect_a_strip_mesh(cut);
  expect_quality(old, cut, width, angle);
  Real longest = 0;
  for (const Index3& t : old.triangles)
    for (int k = 0; k < 3; ++k) longest = std::max(longest, (old.rest[t[k]] - old.rest[t[(k + 1) % 3]]).norm());
  expect_the_rest_unchanged(old, cut, line, 4 * width + 2 * longest + cut.deviation);
  expect_true_parents(old, cut);
  EXPECT_GE(smallest_gap(cut.mesh), 0.2e-3);
  EXPECT_GE(distance_from_followed_line(cut, shortened(cut.line, width / 2)), width / 2 - 1e-9);
}
}  // namespace tape::test
