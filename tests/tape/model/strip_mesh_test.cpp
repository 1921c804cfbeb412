#include "tape/model/strip_mesh.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <set>

using namespace tape;

namespace {
constexpr Real kPi = std::numbers::pi, kWidth = 0.019, kLength = 0.1;
struct Case {
  MeshPattern pattern;
  Real angle;  // [deg]
  int cells_across;
};
const Case kCases[] = {{MeshPattern::same, 0, 6},      {MeshPattern::alternating, 0, 6}, {MeshPattern::crossed, 0, 6},
                       {MeshPattern::irregular, 0, 6}, {MeshPattern::same, 30, 6},       {MeshPattern::same, 45, 6},
                       {MeshPattern::same, 60, 6},     {MeshPattern::same, 90, 6},       {MeshPattern::same, -17, 9},
                       {MeshPattern::same, 1, 2},      {MeshPattern::same, 45, 1},       {MeshPattern::crossed, 0, 1}};
std::string text(const Case& c) {
  return to_text(c.pattern) + " " + to_text(c.angle) + " deg, " + std::to_string(c.cells_across) + " across";
}
StripMesh mesh_of(const Case& c) {
  return make_strip_mesh({.length = kLength, .cells_across = c.cells_across, .pattern = c.pattern, .grid_angle = c.angle}, kWidth, 1);
}
Real area(const StripMesh& m, const Index3& t) {
  const Vec2 a = m.rest[t[1]] - m.rest[t[0]], b = m.rest[t[2]] - m.rest[t[0]];
  return (a.x() * b.y() - a.y() * b.x()) / 2;
}
/// Number of triangles at each edge.
std::map<std::pair<int, int>, int> edges(const StripMesh& m) {
  std::map<std::pair<int, int>, int> count;
  for (const Index3& t : m.triangles)
    for (int k = 0; k < 3; ++k) ++count[std::minmax(int{t[k]}, int{t[(k + 1) % 3]})];
  return count;
}
Real smallest_angle(const StripMesh& m) {
  Real smallest = kPi;
  for (const Index3& t : m.triangles)
    for (int k = 0; k < 3; ++k) {
      const Vec2 a = m.rest[t[(k + 1) % 3]] - m.rest[t[k]], b = m.rest[t[(k + 2) % 3]] - m.rest[t[k]];
      smallest = std::min(smallest, std::acos(a.dot(b) / (a.norm() * b.norm())));
    }
  return smallest * 180 / kPi;
}
int bandwidth(const StripMesh& m) {
  int widest = 0;
  for (const Index3& t : m.triangles) widest = std::max(widest, t.maxCoeff() - t.minCoeff());
  return widest;
}
Strip strip_along(std::vector<PathPiece> path) {
  Strip strip;
  strip.path = std::move(path);
  return strip;
}
}  // namespace

TEST(StripMesh, EveryPatternCoversTheRectangleOnceAndFacesUp) {
  for (const Case& c : kCases) {
    const StripMesh m = mesh_of(c);
    Real sum = 0;
    for (const Index3& t : m.triangles) {
      ASSERT_GT(area(m, t), 0) << text(c);
      sum += area(m, t);
    }
    EXPECT_NEAR(sum, kLength * kWidth, 1e-12 * kLength * kWidth) << text(c);
  }
}

TEST(StripMesh, EveryPatternIsADiscWhoseBoundaryIsTheRectangle) {
  for (const Case& c : kCases) {
    const StripMesh m = mesh_of(c);
    const auto count = edges(m);
    EXPECT_EQ(static_cast<int>(m.rest.size()) - static_cast<int>(count.size()) + static_cast<int>(m.triangles.size()), 1) << text(c);
    Real boundary = 0;
    for (const auto& [edge, triangles] : count) {
      ASSERT_LE(triangles, 2) << text(c);
      if (triangles == 2) continue;
      const Vec2 a = m.rest[edge.first], b = m.rest[edge.second];
      boundary += (a - b).norm();
      const bool on_side = (a.x() == b.x() && (a.x() == 0 || a.x() == kLength)) || (a.y() == b.y() && std::fabs(a.y()) == kWidth / 2);
      EXPECT_TRUE(on_side) << text(c) << " at " << a.transpose();
    }
    EXPECT_NEAR(boundary, 2 * (kLength + kWidth), 1e-12) << text(c);
  }
}

TEST(StripMesh, SquareCellsAreTheDefaultAndStructuredMeshesHaveTheVerticesOfTheirGrid) {
  const StripMesh m = mesh_of({MeshPattern::same, 0, 6});
  EXPECT_EQ(m.rows, 33);  // round(0.1 / (0.019 / 6)) = round(31.58) = 32 cells
  EXPECT_EQ(m.columns, 7);
  EXPECT_EQ(m.rest.size(), 33u * 7u);
  EXPECT_EQ(m.triangles.size(), 32u * 6u * 2u);
  for (int i = 0; i < m.rows; ++i)
    for (int j = 0; j < m.columns; ++j)
      EXPECT_LT((m.rest[i * m.columns + j] - Vec2(kLength * i / 32, kWidth * (j / 6.0 - 0.5))).norm(), 1e-15);
  const StripMesh crossed = mesh_of({MeshPattern::crossed, 0, 6});
  EXPECT_EQ(crossed.columns, 13);
  EXPECT_EQ(crossed.rest.size(), 33u * 7u + 32u * 6u);
  EXPECT_EQ(make_strip_mesh({.length = 0.1, .cells_across = 6, .cell_length = 0.03}, kWidth, 1).rows, 4);
}

TEST(StripMesh, NeighboursStandCloseInTheNumbering) {
  for (const Case& c : kCases) {
    const StripMesh m = mesh_of(c);
    // two rows of vertices of the lattice, and their centres where it is crossed
    const int row = c.pattern == MeshPattern::crossed ? 2 * c.cells_across + 1 : c.cells_across + 1;
    EXPECT_LE(bandwidth(m), c.angle == 0 && c.pattern != MeshPattern::irregular ? row + 1 : 3 * row + 3) << text(c);
    if (c.angle != 0 || c.pattern == MeshPattern::irregular) {
      EXPECT_EQ(m.columns, bandwidth(m)) << text(c);
    }
  }
}

TEST(StripMesh, TrianglesKeepABoundedQuality) {
  for (int seed = 1; seed <= 20; ++seed)
    EXPECT_GT(smallest_angle(make_strip_mesh({.length = 0.3, .pattern = MeshPattern::irregular}, kWidth, seed)), 15) << "seed " << seed;
  for (int angle = -90; angle <= 90; angle += 5)
    EXPECT_GT(smallest_angle(make_strip_mesh({.length = 0.3, .grid_angle = static_cast<Real>(angle)}, kWidth, 1)), 15) << angle << " deg";
}

TEST(StripMesh, AnIrregularMeshDependsOnTheSeedAlone) {
  const StripParams params{.length = 0.1, .pattern = MeshPattern::irregular};
  const StripMesh a = make_strip_mesh(params, kWidth, 1), b = make_strip_mesh(params, kWidth, 1), c = make_strip_mesh(params, kWidth, 2);
  EXPECT_EQ(a.rest, b.rest);
  EXPECT_EQ(a.triangles, b.triangles);
  EXPECT_NE(a.rest, c.rest);
}

TEST(StripMesh, InsideATurnedGridEveryVertexHasTheSixNeighboursOfTheSameDiagonals) {
  for (Real angle : {30.0, 45.0, 60.0, -20.0, 90.0}) {
    const int across = 12;
    const Real dy = kWidth / across, dx = kLength / std::round(kLength / dy), turn = angle * kPi / 180;
    const StripMesh m = make_strip_mesh({.length = kLength, .cells_across = across, .grid_angle = angle}, kWidth, 1);
    const Vec2 u = dx * Vec2(std::cos(turn), std::sin(turn)), v = dy * Vec2(-std::sin(turn), std::cos(turn));
    std::vector<std::set<int>> around(m.rest.size());
    for (const auto& [edge, triangles] : edges(m)) around[edge.first].insert(edge.second), around[edge.second].insert(edge.first);
    int inner = 0;
    for (std::size_t i = 0; i < m.rest.size(); ++i) {
      const Vec2 p = m.rest[i];
      if (std::min({p.x(), kLength - p.x(), kWidth / 2 - std::fabs(p.y())}) < 3 * std::max(dx, dy)) continue;
      ++inner;
      ASSERT_EQ(around[i].size(), 6u) << angle << " deg at " << p.transpose();
      for (int n : around[i]) {  // u, v, u + v and their opposites; never u - v
        const Vec2 e = m.rest[n] - p;
        const Real a = e.dot(u) / u.squaredNorm(), b = e.dot(v) / v.squaredNorm();
        EXPECT_TRUE(std::fabs(a - std::round(a)) < 1e-6 && std::fabs(b - std::round(b)) < 1e-6 && std::round(a) * std::round(b) >= 0)
            << angle << " deg: " << a << ", " << b;
      }
    }
    EXPECT_GT(inner, 200) << angle << " deg";
  }
}

TEST(StripMesh, RootAndTipAreTheVerticesOfTheEndEdges) {
  for (const Case& c : kCases) {
    const StripMesh m = mesh_of(c);
    const auto root = root_vertices(m, 1e-9), tip = tip_vertices(m, 1e-9);
    EXPECT_GE(root.size(), 2u);
    EXPECT_EQ(root.size(), tip.size()) << text(c);
    for (int v : root) EXPECT_EQ(m.rest[v].x(), 0);
    for (int v : tip) EXPECT_EQ(m.rest[v].x(), kLength);
    if (c.angle == 0) {
      EXPECT_EQ(static_cast<int>(root.size()), c.cells_across + 1) << text(c);
    }
  }
}

TEST(StripMesh, AStraightStripIsPlacedWithoutStrainWhereverItsPoseIs) {
  Strip strip;
  strip.pose.rotation = Eigen::AngleAxisd(1.1, Vec3(1, 2, 3).normalized()).toRotationMatrix();
  strip.pose.position = {0.3, -0.2, 0.5};
  const StripMesh m = mesh_of({MeshPattern::irregular, 0, 6});
  const std::vector<Vec3> x = place(m, strip);
  for (const auto& [edge, triangles] : edges(m))
    EXPECT_NEAR((x[edge.first] - x[edge.second]).norm(), (m.rest[edge.first] - m.rest[edge.second]).norm(), 1e-15);
  EXPECT_LT((x[0] - apply(strip.pose, {m.rest[0].x(), m.rest[0].y(), 0})).norm(), 1e-15);
}

TEST(StripMesh, AnArcPutsItsVerticesOnTheCylinderAtTheirArcLength) {
  const Real radius = 0.021;
  const StripMesh m = mesh_of({MeshPattern::same, 0, 6});
  const std::vector<Vec3> x = place(m, strip_along({{0.02, 0}, {radius * kPi, kPi}}));
  const Vec3 centre(0.02, 0, radius);  // a positive turn goes towards the normal, here +z
  for (std::size_t i = 0; i < x.size(); ++i) {
    const Real s = m.rest[i].x(), phi = (s - 0.02) / radius;
    const Vec3 mid(x[i].x(), 0, x[i].z());
    EXPECT_EQ(x[i].y(), m.rest[i].y());
    if (s <= 0.02) {
      EXPECT_LT((mid - Vec3(s, 0, 0)).norm(), 1e-15);
    } else if (phi <= kPi) {
      EXPECT_LT((mid - centre - radius * Vec3(std::sin(phi), 0, -std::cos(phi))).norm(), 1e-15) << "at " << s;
    } else {  // straight on, back over the start
      EXPECT_LT((mid - Vec3(0.02 - (s - 0.02 - radius * kPi), 0, 2 * radius)).norm(), 1e-15) << "at " << s;
    }
  }
}

TEST(StripMesh, ANegativeTurnGoesAwayFromTheNormal) {
  const StripMesh m = mesh_of({MeshPattern::same, 0, 1});
  EXPECT_GT(place(m, strip_along({{0.1, 1}})).back().z(), 0);
  EXPECT_LT(place(m, strip_along({{0.1, -1}})).back().z(), 0);
}

TEST(StripMesh, SettingsThatCannotBeMeshedAreRefused) {
  EXPECT_THROW(make_strip_mesh({.pattern = MeshPattern::crossed, .grid_angle = 30}, kWidth, 1), InputError);
  EXPECT_THROW(make_strip_mesh({.cells_across = 0}, kWidth, 1), InputError);
  EXPECT_THROW(make_strip_mesh({.length = 100, .cell_length = 1e-9}, kWidth, 1), InputError);
}
