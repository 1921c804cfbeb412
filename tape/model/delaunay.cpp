#include "tape/model/delaunay.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <utility>

#include "tape/core/error.hpp"

namespace tape {
namespace {
Real cross(const Vec2& a, const Vec2& b) { return a.x() * b.y() - a.y() * b.x(); }

/// Twice the signed area of a triangle: positive if counter-clockwise.
Real orientation(const std::vector<Vec2>& p, int a, int b, int c) { return cross(p[b] - p[a], p[c] - p[a]); }

/// The hull that grows point by point in a sweep, as a ring of vertices, counter-clockwise.
class SweepHull {
 public:
  explicit SweepHull(const std::vector<Vec2>& points) : points_(points), next_(points.size()), prev_(points.size()) {
    for (const Vec2& p : points) extent_ = std::max(extent_, (p - points[0]).norm());
  }
  bool collinear(int a, int b, int c) const { return std::fabs(orientation(points_, a, b, c)) <= round_off(a, b, c); }

  /// Starts from a row of collinear points and one beside it.
  void start(const std::vector<int>& row, int apex) {
    std::vector<int> ring = row;
    if (orientation(points_, row.front(), row.back(), apex) < 0) std::reverse(ring.begin(), ring.end());
    for (std::size_t i = 0; i + 1 < ring.size(); ++i) triangles.push_back({ring[i], ring[i + 1], apex});
    ring.push_back(apex);
    for (std::size_t i = 0; i < ring.size(); ++i) join(ring[i], ring[(i + 1) % ring.size()]);
  }
  /// Adds a point outside the hull. @param last  a hull vertex that it sees
  void add(int p, int last) {
    int right = last, left = last;
    for (; sees(p, left, next_[left]); left = next_[left]) triangles.push_back({left, p, next_[left]});
    for (; sees(p, prev_[right], right); right = prev_[right]) triangles.push_back({prev_[right], p, right});
    TAPE_CHECK(left != right);
    join(right, p);
    join(p, left);
  }
  std::vector<Index3> triangles;

 private:
  bool sees(int p, int a, int b) const { return orientation(points_, a, b, p) < -round_off(a, b, p); }
  /// [m^2] what rounded coordinates may do to an orientation
  Real round_off(int a, int b, int c) const {
    return 1e-14 * extent_ * ((points_[b] - points_[a]).norm() + (points_[c] - points_[a]).norm());
  }
  void join(int a, int b) { next_[a] = b, prev_[b] = a; }
  const std::vector<Vec2>& points_;
  std::vector<int> next_, prev_;
  Real extent_ = 0;  // [m]
};

/// A triangulation whose inner edges can be flipped. Neighbour k of a triangle lies across the edge opposite to its vertex k.
class Flipper {
 public:
  Flipper(const std::vector<Vec2>& points, const std::vector<Vec2>& metric, std::vector<Index3>& triangles)
      : points_(points), metric_(metric), triangles_(triangles), neighbours_(triangles.size(), Index3(-1, -1, -1)) {
    std::vector<std::array<int, 4>> sides;  // smaller vertex, larger vertex, triangle, corner
    for (int t = 0; t < static_cast<int>(triangles.size()); ++t)
      for (int k = 0; k < 3; ++k) {
        const auto [a, b] = std::minmax(triangles[t][(k + 1) % 3], triangles[t][(k + 2) % 3]);
        sides.push_back({a, b, t, k});
      }
    std::sort(sides.begin(), sides.end());
    for (std::size_t i = 0; i + 1 < sides.size(); ++i) {
      const auto &s = sides[i], &o = sides[i + 1];
      if (s[0] == o[0] && s[1] == o[1]) neighbours_[s[2]][s[3]] = o[2], neighbours_[o[2]][o[3]] = s[2];
    }
  }
  void run() {
    std::vector<std::pair<int, int>> pending;  // triangle, corner
    for (int t = static_cast<int>(triangles_.size()) - 1; t >= 0; --t)
      for (int k = 0; k < 3; ++k) pending.push_back({t, k});
    while (!pending.empty()) {
      const auto [t, k] = pending.back();
      pending.pop_back();
      const int u = neighbours_[t][k];
      if (u < 0 || !improves(t, k, corner_facing(u, t))) continue;
      flip(t, k, u, corner_facing(u, t));
      for (int s : {t, u})
        for (int c = 0; c < 3; ++c) pending.push_back({s, c});
    }
  }

 private:
  int corner_facing(int t, int other) const {
    for (int k = 0; k < 3; ++k)
      if (neighbours_[t][k] == other) return k;
    TAPE_CHECK(false);
    return -1;
  }
  /// The angles that face an edge of a Delaunay triangulation add up to at most pi. The flipped pair must stay proper triangles.
  bool improves(int t, int k, int l) const {
    const int a = triangles_[t][k], b = triangles_[t][(k + 1) % 3], c = triangles_[t][(k + 2) % 3];
    const int d = triangles_[neighbours_[t][k]][l];
    const Vec2 ab = metric_[b] - metric_[a], ac = metric_[c] - metric_[a], db = metric_[b] - metric_[d], dc = metric_[c] - metric_[d];
    const Real scale = ab.norm() * ac.norm() * db.norm() * dc.norm();
    const Real sine_of_sum = cross(ab, ac) * db.dot(dc) + ab.dot(ac) * cross(dc, db);
    if (sine_of_sum >= -1e-9 * scale) return false;
    const Real area = 1e-9 * (points_[a] - points_[d]).squaredNorm();
    return orientation(points_, a, b, d) > area && orientation(points_, a, d, c) > area;
  }
  /// Edge bc between t = (a, b, c) and u = (d, c, b) becomes ad: t = (a, b, d), u = (a, d, c).
  void flip(int t, int k, int u, int l) {
    const int a = triangles_[t][k], b = triangles_[t][(k + 1) % 3], c = triangles_[t][(k + 2) % 3], d = triangles_[u][l];
    const int ca = neighbours_[t][(k + 1) % 3], ab = neighbours_[t][(k + 2) % 3];
    const int bd = neighbours_[u][(l + 1) % 3], dc = neighbours_[u][(l + 2) % 3];
    if (bd >= 0) neighbours_[bd][corner_facing(bd, u)] = t;
    if (ca >= 0) neighbours_[ca][corner_facing(ca, t)] = u;
    triangles_[t] = {a, b, d}, neighbours_[t] = {bd, u, ab};
    triangles_[u] = {a, d, c}, neighbours_[u] = {dc, ca, t};
  }
  const std::vector<Vec2>&points_, &metric_;
  std::vector<Index3>& triangles_;
  std::vector<Index3> neighbours_;
};
}  // namespace

std::vector<Index3> triangulate_hull(const std::vector<Vec2>& points) {
  // The sweep goes in a direction that lattices do not have, so that no row of points arrives at once.
  const Vec2 direction(1, 0.1234567891);
  std::vector<int> order(points.size());
  std::iota(order.begin(), order.end(), 0);
  std::sort(order.begin(), order.end(), [&](int a, int b) { return direction.dot(points[a]) < direction.dot(points[b]); });
  SweepHull hull(points);
  std::vector<int> row(order.begin(), order.begin() + 2);
  std::size_t i = 2;
  while (i < order.size() && hull.collinear(row.front(), row.back(), order[i])) row.push_back(order[i++]);
  TAPE_CHECK(i < order.size());
  hull.start(row, order[i]);
  for (++i; i < order.size(); ++i) hull.add(order[i], order[i - 1]);
  return hull.triangles;
}

void flip_to_delaunay(const std::vector<Vec2>& points, const std::vector<Vec2>& metric, std::vector<Index3>& triangles) {
  Flipper(points, metric, triangles).run();
}
}  // namespace tape
