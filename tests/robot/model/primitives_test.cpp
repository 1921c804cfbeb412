#include "robot/model/primitives.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <numbers>

#include "robot/model/inertia.hpp"
using namespace robot;

namespace {
/// Each edge twice, in opposite directions.
bool is_closed(const TriangleMesh& mesh) {
  std::map<std::pair<int, int>, int> edges;
  for (const auto& [a, b, c] : mesh.triangles) ++edges[{a, b}], ++edges[{b, c}], ++edges[{c, a}];
  for (const auto& [edge, count] : edges)
    if (count != 1 || !edges.contains({edge.second, edge.first})) return false;
  return true;
}
constexpr Real kPi = std::numbers::pi;
/// Area of a polygon of 64 corners on a circle, over that of the circle.
const Real kPolygon = std::sin(2 * kPi / 64) / (2 * kPi / 64);
}  // namespace

TEST(Primitives, AreClosedAndFaceOutward) {
  for (const Shape& s : {box_shape({1, 2, 3}), cylinder_shape(0.5, 2), sphere_shape(0.5)}) {
    EXPECT_TRUE(is_closed(s.mesh));
    EXPECT_GT(solid(s.mesh, 1).mass, 0);
    EXPECT_LT(solid(s.mesh, 1).com.norm(), 1e-14);
  }
}

TEST(Primitives, HaveTheVolumeOfTheirShape) {
  EXPECT_NEAR(solid(box_shape({1, 2, 3}).mesh, 1).mass, 6, 1e-14);
  EXPECT_NEAR(solid(cylinder_shape(0.5, 2).mesh, 1).mass, kPolygon * kPi * 0.25 * 2, 1e-14);
  const Real sphere = solid(sphere_shape(0.5).mesh, 1).mass, exact = 4.0 / 3 * kPi * 0.125;
  EXPECT_LT(sphere, exact);  // its facets lie inside, nowhere deeper than the middle of one: cos(pi / 32) of the radius each way
  EXPECT_GT(sphere, exact * std::pow(std::cos(kPi / 32), 6));
}

TEST(Primitives, KnowTheirSizeAndPose) {
  const Pose X(Eigen::Translation3d(1, 2, 3));
  EXPECT_EQ(box_shape({1, 2, 3}, X).size, Vec3(1, 2, 3));
  EXPECT_EQ(cylinder_shape(0.5, 2, X).size, Vec3(0.5, 0.5, 2));
  EXPECT_EQ(sphere_shape(0.5, X).size, Vec3(0.5, 0.5, 0.5));
  EXPECT_EQ(cylinder_shape(0.5, 2, X).X_LS.translation(), Vec3(1, 2, 3));
  EXPECT_EQ(cylinder_shape(0.5, 2).kind, Shape::Kind::cylinder);
  EXPECT_EQ(sphere_shape(0.5).kind, Shape::Kind::sphere);
}
