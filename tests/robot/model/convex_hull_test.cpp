#include "robot/model/convex_hull.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <iterator>
#include <map>
#include <random>

#include "robot/model/inertia.hpp"
#include "robot/model/primitives.hpp"
#include "tests/robot/support/folder.hpp"
using namespace robot;
using namespace robot::test;

namespace {
/// Corners, points inside, on faces and on edges of a box.
std::vector<Vec3> box_points(const Vec3& size) {
  std::vector<Vec3> points;
  for (int i = 0; i <= 4; ++i)
    for (int j = 0; j <= 4; ++j)
      for (int k = 0; k <= 4; ++k) points.push_back(size.cwiseProduct(Vec3(i, j, k) / 4));
  return points;
}

/// Inside a ball, and some on it.
std::vector<Vec3> ball_points(int count) {
  std::mt19937 random(3);
  std::normal_distribution<Real> normal;
  std::vector<Vec3> points;
  for (int i = 0; i < count; ++i) points.push_back(Vec3(normal(random), normal(random), normal(random)).normalized() * (i % 3 ? 0.5 : 1));
  return points;
}

int euler_number(const TriangleMesh& mesh) {
  std::map<std::pair<int, int>, int> edges;
  for (const auto& [a, b, c] : mesh.triangles)
    for (const auto& [i, j] : {std::pair(a, b), std::pair(b, c), std::pair(c, a)}) ++edges[std::minmax(i, j)];
  for (const auto& [edge, count] : edges) EXPECT_EQ(count, 2);
  return static_cast<int>(mesh.vertices.size()) - static_cast<int>(edges.size()) + static_cast<int>(mesh.triangles.size());
}

std::string content(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

fs::path only_file(const fs::path& folder) {
  const auto files = std::vector<fs::directory_entry>(fs::directory_iterator(folder), {});
  EXPECT_EQ(files.size(), 1u);
  return files.front().path();
}

void expect_same(const TriangleMesh& a, const TriangleMesh& b) {
  EXPECT_EQ(a.vertices, b.vertices);
  EXPECT_EQ(a.triangles, b.triangles);
}
}  // namespace

TEST(ConvexHull, OfABoxFullOfPointsIsTheBox) {
  const TriangleMesh hull = convex_hull(box_points({0.1, 0.2, 0.4}));
  EXPECT_EQ(hull.vertices.size(), 8u);
  EXPECT_EQ(hull.triangles.size(), 12u);
  EXPECT_EQ(euler_number(hull), 2);
  EXPECT_NEAR(solid(hull, 1).mass, 0.008, 1e-17);
}

TEST(ConvexHull, IsClosedFacesOutwardAndHoldsEveryPoint) {
  const std::vector<Vec3> points = ball_points(600);
  const TriangleMesh hull = convex_hull(points);
  EXPECT_EQ(euler_number(hull), 2);
  for (const auto& [a, b, c] : hull.triangles) {
    const Vec3 normal = (hull.vertices[b] - hull.vertices[a]).cross(hull.vertices[c] - hull.vertices[a]).normalized();
    for (const Vec3& p : points) EXPECT_LT(normal.dot(p - hull.vertices[a]), 2e-4);  // Bullet's rounding, 1e-4 of an extent of 2
  }
}

TEST(ConvexHull, KeepsTheCoordinatesOfThePoints) {
  const std::vector<Vec3> points = ball_points(200);
  for (const Vec3& v : convex_hull(points).vertices) EXPECT_NE(std::find(points.begin(), points.end(), v), points.end());
}

TEST(ConvexHull, OfFlatOrTooFewOrInfinitePointsIsRefused) {
  const std::vector<Vec3> tilted = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0.2, 0.3, 0.5}, {0.5, 0.5, 0}};
  EXPECT_THROW(convex_hull(tilted), InputError);
  EXPECT_THROW(convex_hull({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}), InputError);
  EXPECT_THROW(convex_hull(std::vector<Vec3>{}), InputError);
  EXPECT_THROW(convex_hull({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, std::nan("")}}), InputError);
}

TEST(ConvexHull, AShrunkHullHasItsFacesInsideByTheDistanceOrATenthOfTheInnerRadius) {
  for (const auto& [size, by] : {std::pair(Vec3(0.2, 0.3, 0.4), 1e-3), {Vec3(0.2, 0.3, 2e-3), 1e-4}}) {  // inner radius 0.1 m, 1 mm
    const ShrunkHull hull = shrunk_hull(box_points(size), 1e-3);
    EXPECT_NEAR(hull.by, by, 1e-9);
    EXPECT_EQ(hull.vertices.size(), 8u);
    for (const Vec3& p : hull.vertices)
      EXPECT_LT(((p - size / 2).cwiseAbs() - size / 2 + Vec3::Constant(by)).cwiseAbs().maxCoeff(), 1e-4 * size.maxCoeff());
  }
  EXPECT_THROW(shrunk_hull({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}}, 1e-3), InputError);
}

TEST(ConvexHull, TheCacheGivesTheSameHullAgainWithoutComputing) {
  const Folder folder;
  const fs::path cache = folder.path() / "made" / "here";
  const std::vector<Vec3> points = ball_points(200);
  expect_same(convex_hull(points, cache), convex_hull(points));
  // A file that says otherwise is believed, so it is read: the same hull with its triangles in another order.
  const fs::path file = only_file(cache);
  TriangleMesh hull = convex_hull(points);
  std::string text = content(file);
  const std::size_t end = text.rfind("end"), last = text.rfind('\n', end - 2) + 1;
  const std::size_t start = text.find(std::to_string(hull.triangles[0][0]) + " " + std::to_string(hull.triangles[0][1]) + " ");
  const std::string moved_line = text.substr(last, end - last);
  text.erase(last, end - last);
  text.insert(start, moved_line);
  std::ofstream(file) << text;
  std::rotate(hull.triangles.begin(), hull.triangles.end() - 1, hull.triangles.end());
  expect_same(convex_hull(points, cache), hull);
}

TEST(ConvexHull, EachSetOfPointsHasItsOwnFile) {
  const Folder folder;
  convex_hull(ball_points(200), folder.path());
  convex_hull(ball_points(201), folder.path());
  std::vector<Vec3> changed = ball_points(200);
  changed[7].x() += 1e-15;
  convex_hull(changed, folder.path());
  EXPECT_EQ(std::distance(fs::directory_iterator(folder.path()), {}), 3);
}

TEST(ConvexHull, ACorruptedCacheFileIsWrittenAnew) {
  const Folder folder;
  const std::vector<Vec3> points = box_points({1, 1, 1});
  const TriangleMesh expected = convex_hull(points, folder.path());
  const fs::path file = only_file(folder.path());
  const std::string good = content(file);
  const std::size_t end = good.rfind("end"), last = good.rfind('\n', end - 2) + 1;
  std::string open = good, far = good;
  open.erase(last, end - last).replace(0, 4, "8 11");  // a triangle less
  far.replace(far.find('\n') + 1, 1, "999");           // a point that is not there
  for (const std::string& bad : {std::string(), std::string("\0\1\2", 3), good.substr(0, good.size() / 2), good.substr(0, end),
                                 good.substr(0, end) + "x", "-1" + good, "99999999999 " + good, open, far}) {
    std::ofstream(file, std::ios::binary) << bad;
    expect_same(convex_hull(points, folder.path()), expected);
    EXPECT_EQ(content(file), good);
    EXPECT_EQ(only_file(folder.path()), file);  // nothing temporary stays
  }
}

TEST(ConvexHull, AFolderThatCannotBeMadeIsDoneWithout) {
  const Folder folder;
  const fs::path file = folder.write("file", "x");
  const std::vector<Vec3> points = box_points({1, 1, 1});
  expect_same(convex_hull(points, file / "cache"), convex_hull(points));
  expect_same(convex_hull(points, fs::path()), convex_hull(points));
}
