#include "tape/model/delaunay.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <deque>
#include <map>
#include <numeric>
#include <set>
#include <utility>

#include "tape/core/error.hpp"
#include "tape/math/plane.hpp"

namespace tape {
namespace {
Real orientation(const std::vector<Vec2>& p, int a, int b, int c) { return turn(p[a], p[b], p[c]); }

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
  /// Those of `edges` that are there stay from now on.
  /// @returns the others
  std::vector<Index2> fix(const std::vector<Index2>& edges) {
    std::set<std::pair<int, int>> present;
    for (const Index3& t : triangles_)
      for (int k = 0; k < 3; ++k) present.insert(std::minmax(t[k], t[(k + 1) % 3]));
    std::vector<Index2> missing;
    for (const Index2& e : edges) {
      if (present.contains(std::minmax(e[0], e[1])))
        fixed_.insert(std::minmax(e[0], e[1]));
      else
        missing.push_back(e);
    }
    return missing;
  }
  /// Flips until a-b is an edge, which then stays.
  /// @returns whether it could be done: no other point is on it, and it crosses no edge that stays
  bool recover(int a, int b) {
    std::deque<std::pair<int, int>> crossing;
    bool there = false;  // another side's flips may have made it
    for (const Index3& t : triangles_)
      for (int k = 0; k < 3; ++k) {
        const int u = t[k], v = t[(k + 1) % 3];
        there = there || std::minmax(u, v) == std::minmax(a, b);
        if (u < v && cross_each_other(a, b, u, v)) crossing.push_back({u, v});
      }
    for (std::size_t patience = 50 * (crossing.size() + 1); !crossing.empty(); --patience) {
      const auto [u, v] = crossing.front();
      crossing.pop_front();
      const auto [t, k] = edge(u, v);
      if (patience == 0 || fixed_.contains({u, v}) || neighbours_[t][k] < 0) return false;
      const int o = neighbours_[t][k], l = corner_facing(o, t), p = triangles_[t][k], q = triangles_[o][l];
      if (!convex(t, k, o, l)) {
        crossing.push_back({u, v});
        continue;
      }
      flip(t, k, o, l);
      if (cross_each_other(a, b, p, q)) crossing.push_back(std::minmax(p, q));
      there = there || std::minmax(p, q) == std::minmax(a, b);
    }
    if (there) fixed_.insert(std::minmax(a, b));
    return there;
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
    if (!fixed_.empty() && fixed_.contains(std::minmax(b, c))) return false;
    const Vec2 ab = metric_[b] - metric_[a], ac = metric_[c] - metric_[a], db = metric_[b] - metric_[d], dc = metric_[c] - metric_[d];
    const Real scale = ab.norm() * ac.norm() * db.norm() * dc.norm();
    const Real sine_of_sum = cross(ab, ac) * db.dot(dc) + ab.dot(ac) * cross(dc, db);
    return sine_of_sum < -1e-9 * scale && convex(t, k, neighbours_[t][k], l);
  }
  /// Whether both triangles of the flipped pair are proper ones.
  bool convex(int t, int k, int u, int l) const {
    const int a = triangles_[t][k], b = triangles_[t][(k + 1) % 3], c = triangles_[t][(k + 2) % 3], d = triangles_[u][l];
    const Real area = 1e-9 * (points_[a] - points_[d]).squaredNorm();
    return orientation(points_, a, b, d) > area && orientation(points_, a, d, c) > area;
  }
  bool cross_each_other(int a, int b, int u, int v) const {
    if (u == a || u == b || v == a || v == b) return false;
    return (orientation(points_, a, b, u) > 0) != (orientation(points_, a, b, v) > 0) &&
           (orientation(points_, u, v, a) > 0) != (orientation(points_, u, v, b) > 0);
  }
  /// A triangle at the edge u-v, and its corner that faces it.
  std::pair<int, int> edge(int u, int v) const {
    for (int t = 0; t < static_cast<int>(triangles_.size()); ++t)
      for (int k = 0; k < 3; ++k)
        if (std::minmax(triangles_[t][(k + 1) % 3], triangles_[t][(k + 2) % 3]) == std::minmax(u, v)) return {t, k};
    TAPE_CHECK(false);
    return {-1, -1};
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
  std::set<std::pair<int, int>> fixed_;  // smaller vertex, larger vertex
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

std::vector<Index3> triangulate_inside(const std::vector<Vec2>& points, const std::vector<Index2>& sides) {
  std::vector<Index3> triangles = triangulate_hull(points);
  Flipper flipper(points, points, triangles);
  flipper.run();
  for (const Index2& s : flipper.fix(sides))
    if (!flipper.recover(s[0], s[1])) return {};
  flipper.run();

  std::set<std::pair<int, int>> border;
  for (const Index2& s : sides) border.insert({s[0], s[1]});
  std::map<std::pair<int, int>, int> left;  // triangle on the left of an edge
  std::vector<int> pending;
  for (int t = 0; t < static_cast<int>(triangles.size()); ++t)
    for (int k = 0; k < 3; ++k) {
      const std::pair<int, int> edge{triangles[t][k], triangles[t][(k + 1) % 3]};
      left[edge] = t;
      if (border.contains(edge)) pending.push_back(t);
    }
  std::vector<bool> inside(triangles.size(), false);
  while (!pending.empty()) {
    const int t = pending.back();
    pending.pop_back();
    if (inside[t]) continue;
    inside[t] = true;
    for (int k = 0; k < 3; ++k) {
      const int a = triangles[t][k], b = triangles[t][(k + 1) % 3];
      if (border.contains({a, b})) continue;
      const auto across = left.find({b, a});
      if (border.contains({b, a}) || across == left.end()) return {};  // the sides do not enclose an area
      pending.push_back(across->second);
    }
  }
  std::vector<Index3> kept;
  for (std::size_t t = 0; t < triangles.size(); ++t)
    if (inside[t]) kept.push_back(triangles[t]);
  return kept;
}
}  // namespace tape
