#include "tape/model/delaunay.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <set>
#include <utility>

#include "tape/math/plane.hpp"

using namespace tape;

namespace {
Real area(const std::vector<Vec2>& p, const std::vector<Index3>& triangles) {
  Real sum = 0;
  for (const Index3& t : triangles) sum += turn(p[t[0]], p[t[1]], p[t[2]]) / 2;
  return sum;
}
bool has_edge(const std::vector<Index3>& triangles, int a, int b) {
  for (const Index3& t : triangles)
    for (int k = 0; k < 3; ++k)
      if (std::minmax({int{t[k]}, int{t[(k + 1) % 3]}}) == std::minmax({a, b})) return true;
  return false;
}
std::vector<Index2> loop(int first, int count) {
  std::vector<Index2> sides;
  for (int k = 0; k < count; ++k) sides.push_back({first + k, first + (k + 1) % count});
  return sides;
}
}  // namespace

TEST(TriangulateInside, FillsAConcaveOutlineAndNothingElse) {
  // An L of three unit squares, a point in its middle, one in the notch outside.
  const std::vector<Vec2> p{{0, 0}, {2, 0}, {2, 1}, {1, 1}, {1, 2}, {0, 2}, {0.7, 0.6}, {1.6, 1.7}};
  const std::vector<Index3> triangles = triangulate_inside(p, loop(0, 6));
  EXPECT_DOUBLE_EQ(area(p, triangles), 3);
  EXPECT_EQ(triangles.size(), 6u);  // 6 sides, 1 point inside: 6 - 2 + 2 x 1
  for (const Index3& t : triangles) EXPECT_GT(turn(p[t[0]], p[t[1]], p[t[2]]), 0);
}
TEST(TriangulateInside, LeavesHolesOpen) {
  std::vector<Vec2> p{{0, 0}, {3, 0}, {3, 3}, {0, 3}, {1, 1}, {1, 2}, {2, 2}, {2, 1}};  // the hole is clockwise
  std::vector<Index2> sides = loop(0, 4);
  for (const Index2& s : loop(4, 4)) sides.push_back(s);
  EXPECT_DOUBLE_EQ(area(p, triangulate_inside(p, sides)), 8);
}
TEST(TriangulateInside, ASideStaysAlsoWhereDelaunayWouldFlipItAway) {
  // A slit 2 wide and 0.02 high between two rows of points that are nearer to each other than its ends are.
  std::vector<Vec2> p{{0, -1}, {2, -1}, {2, 1}, {0, 1}, {0.1, 0}, {1, 0.01}, {1.9, 0}, {1, -0.01}};
  for (int k = 1; k < 8; ++k) p.push_back({0.25 * k, 0.1}), p.push_back({0.25 * k, -0.1});
  std::vector<Index2> sides = loop(0, 4);
  for (const Index2& s : loop(4, 4)) sides.push_back(s);
  const std::vector<Index3> triangles = triangulate_inside(p, sides);
  for (const Index2& s : sides) EXPECT_TRUE(has_edge(triangles, s[0], s[1])) << s.transpose();
  EXPECT_NEAR(area(p, triangles), 4 - 0.018, 1e-14);  // the hole is a rhombus with diagonals 1.8 and 0.02
}
TEST(TriangulateInside, RandomStarsAreFilledAndDelaunay) {
  std::mt19937_64 generator(3);
  const auto random = [&] { return static_cast<Real>(generator() >> 11) * 0x1p-53; };
  for (int run = 0; run < 50; ++run) {
    const int corners = 5 + run;
    std::vector<Vec2> p;
    for (int k = 0; k < corners; ++k) {
      const Real angle = 2 * 3.14159265358979 * k / corners, radius = 0.5 + random();
      p.push_back({radius * std::cos(angle), radius * std::sin(angle)});
    }
    Real outline = 0;
    for (int k = 0; k < corners; ++k) outline += cross(p[k], p[(k + 1) % corners]) / 2;
    for (int k = 0; k < 40; ++k) p.push_back(0.45 * Vec2(2 * random() - 1, 2 * random() - 1) / std::sqrt(2));
    const std::vector<Index2> sides = loop(0, corners);
    const std::vector<Index3> triangles = triangulate_inside(p, sides);
    EXPECT_NEAR(area(p, triangles), outline, 1e-13);
    EXPECT_EQ(triangles.size(), static_cast<std::size_t>(corners - 2 + 2 * 40));
    std::set<std::pair<int, int>> border;
    for (const Index2& s : sides) border.insert({s[0], s[1]});
    for (const Index3& t : triangles)
      for (const Index3& u : triangles)
        for (int k = 0; k < 3; ++k)
          for (int l = 0; l < 3; ++l)
            if (t[k] == u[(l + 1) % 3] && t[(k + 1) % 3] == u[l]) {
              const Vec2 &a = p[t[k]], &b = p[t[(k + 1) % 3]], &c = p[t[(k + 2) % 3]], &d = p[u[(l + 2) % 3]];
              EXPECT_LE(angle_at(c, a, b) + angle_at(d, a, b), 3.14159265358979 + 1e-6);
            }
  }
}
TEST(TriangulateInside, SidesThatCrossOrPassThroughAPointOrEncloseNothingGiveNoTriangles) {
  const std::vector<Vec2> bow{{0, 0}, {2, 2}, {2, 0}, {0, 2}};
  EXPECT_TRUE(triangulate_inside(bow, loop(0, 4)).empty());
  const std::vector<Vec2> square{{0, 0}, {2, 0}, {2, 2}, {0, 2}, {1, 0}, {1, 1}};
  EXPECT_TRUE(triangulate_inside(square, loop(0, 4)).empty());  // point 4 is on the first side
  EXPECT_TRUE(triangulate_inside(bow, {{0, 2}, {2, 1}}).empty());
}
