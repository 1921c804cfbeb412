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
    for (int worst = worst_mendable(); worst >= 0 && now_.points.size() < most; worst = worst_mendable()) {
      if (!mend(now_.triangles[worst])) {
        hopeless_.insert(key(now_.triangles[worst]));
        continue;
      }
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
  int worst_mendable() const {
    int worst = -1;
    Real smallest = angle_;
    for (int t = 0; t < static_cast<int>(now_.triangles.size()); ++t)
      if (const Real a = angle(now_.triangles[t]); a < smallest && !hopeless_.contains(key(now_.triangles[t]))) smallest = a, worst = t;
    return worst;
  }

  bool mend(const Index3& t) {
    const Vec2 &a = point(t[0]), ab = point(t[1]) - a, ac = point(t[2]) - a;
    const Vec2 centre = a - left_of(ac * ab.squaredNorm() - ab * ac.squaredNorm()) / (2 * cross(ab, ac));
    const int side = side_in_the_way(a + (ab + ac) / 3, centre);
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
