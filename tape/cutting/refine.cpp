#include "tape/cutting/refine.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <numbers>
#include <set>
#include <utility>

#include "tape/math/plane.hpp"
#include "tape/model/delaunay.hpp"

namespace tape {
namespace {
class Refiner {
 public:
  Refiner(const Outline& outline, const std::vector<Vec2>& inner, Real angle, Real shortest)
      : sides_(outline.sides), seam_(outline.seam), angle_(angle), shortest_(shortest) {
    now_.points = outline.points;
    now_.points.insert(now_.points.end(), inner.begin(), inner.end());
  }
  Triangulation run() {
    triangulate();
    Triangulation best = now_;
    const std::size_t most = 2 * now_.points.size() + 50;
    while (now_.points.size() < most && mend_bad_ones()) {
      triangulate();
      if (now_.smallest_angle >= best.smallest_angle) best = now_;
    }
    return best;
  }

 private:
  static std::array<int, 3> key(const Index3& t) {
    std::array<int, 3> k{t[0], t[1], t[2]};
    std::sort(k.begin(), k.end());
    return k;
  }
  const Vec2& point(int i) const { return now_.points[i]; }

  void triangulate() {
    now_.triangles = triangulate_inside(now_.points, sides_);
    now_.smallest_angle = std::numbers::pi;
    for (const Index3& t : now_.triangles) now_.smallest_angle = std::min(now_.smallest_angle, angle(t));
  }
  Real angle(const Index3& t) const { return smallest_angle(point(t[0]), point(t[1]), point(t[2])); }
  /// One round over the bad triangles, the worst first; one that a point of this round will break up is left to the next.
  bool mend_bad_ones() {
    std::vector<std::pair<Real, int>> bad;
    for (int t = 0; t < static_cast<int>(now_.triangles.size()); ++t)
      if (const Real a = angle(now_.triangles[t]); a < angle_ && !hopeless_.contains(key(now_.triangles[t]))) bad.push_back({a, t});
    std::sort(bad.begin(), bad.end());
    const std::size_t before = now_.points.size();
    for (const auto& [a, t] : bad)
      if (!is_broken_up(now_.triangles[t], before) && !mend(now_.triangles[t])) hopeless_.insert(key(now_.triangles[t]));
    return now_.points.size() > before;
  }
  Vec2 circumcentre(const Index3& t) const {
    const Vec2 &a = point(t[0]), ab = point(t[1]) - a, ac = point(t[2]) - a;
    return a - left_of(ac * ab.squaredNorm() - ab * ac.squaredNorm()) / (2 * cross(ab, ac));
  }
  bool is_broken_up(const Index3& t, std::size_t first_new) const {
    const Vec2 centre = circumcentre(t);
    const Real radius2 = (point(t[0]) - centre).squaredNorm();
    return std::any_of(now_.points.begin() + static_cast<std::ptrdiff_t>(first_new), now_.points.end(),
                       [&](const Vec2& p) { return (p - centre).squaredNorm() < radius2; });
  }

  bool mend(const Index3& t) {
    const Vec2 centre = circumcentre(t);
    const int side = side_in_the_way((point(t[0]) + point(t[1]) + point(t[2])) / 3, centre);
    if (side < 0) return insert(centre);
    if (seam_[side]) return false;
    const auto [from, to] = std::pair(sides_[side][0], sides_[side][1]);
    const int middle = static_cast<int>(now_.points.size());
    if (!insert((point(from) + point(to)) / 2)) return false;
    sides_[side][1] = middle;
    sides_.push_back({middle, to});
    seam_.push_back(0);
    return true;
  }
  /// The side that a point would encroach upon, or that hides it from `from`; -1: none.
  int side_in_the_way(const Vec2& from, const Vec2& p) const {
    int found = -1;
    Real nearest = std::numeric_limits<Real>::infinity();
    for (int s = 0; s < static_cast<int>(sides_.size()); ++s) {
      const Vec2 &a = point(sides_[s][0]), &b = point(sides_[s][1]);
      const bool encroached = (a - p).dot(b - p) < 0;
      const bool hides = turn(a, b, from) * turn(a, b, p) < 0 && turn(from, p, a) * turn(from, p, b) < 0;
      if (!encroached && !hides) continue;
      if (const Real d = distance_to_segment(from, a, b); d < nearest) nearest = d, found = s;
    }
    return found;
  }
  bool insert(const Vec2& p) {
    for (const Vec2& q : now_.points)
      if ((p - q).norm() < shortest_) return false;
    now_.points.push_back(p);
    return true;
  }

  std::vector<Index2> sides_;
  std::vector<char> seam_;
  Real angle_, shortest_;
  std::set<std::array<int, 3>> hopeless_;
  Triangulation now_;
};
}  // namespace

Triangulation triangulate(const Outline& outline, const std::vector<Vec2>& inner, Real angle, Real shortest) {
  return Refiner(outline, inner, angle, shortest).run();
}
}  // namespace tape
