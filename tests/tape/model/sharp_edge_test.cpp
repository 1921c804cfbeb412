#include "tape/model/sharp_edge.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tape/model/primitives.hpp"
using namespace tape;

namespace {
constexpr Real kSharp = std::numbers::pi / 4;
/// A bar along x whose cross-section is a triangle with its tip, of angle 2 atan(0.5/4), at z = 4; the tip's line goes up and down.
TriangleMesh saw(int teeth) {
  TriangleMesh mesh;
  const auto section = [&](Real x, Real tip) {
    mesh.vertices.insert(mesh.vertices.end(), {Vec3(x, -0.5, 0), Vec3(x, 0.5, 0), Vec3(x, 0, tip)});
  };
  for (int k = 0; k <= 2 * teeth; ++k) section(k, k % 2 == 0 ? 4 : 4.5);
  const int n = 2 * teeth;
  for (int k = 0; k < n; ++k)
    for (int a = 0; a < 3; ++a) {
      const int b = (a + 1) % 3, p = 3 * k;
      mesh.triangles.insert(mesh.triangles.end(), {Index3(p + a, p + b, p + 3 + b), Index3(p + a, p + 3 + b, p + 3 + a)});
    }
  mesh.triangles.insert(mesh.triangles.end(), {Index3(0, 2, 1), Index3(3 * n, 3 * n + 1, 3 * n + 2)});
  return mesh;
}
}  // namespace

TEST(SharpEdge, OfAWedgeIsItsEdge) {
  const std::vector<Vec3> edge = sharp_edge(wedge_mesh(Vec3(0.001, 0.03, 0.01)), kSharp);
  ASSERT_EQ(edge.size(), 2u);
  EXPECT_NEAR((edge[1] - edge[0]).norm(), 0.03, 1e-15);
  EXPECT_NEAR(edge[0].z(), edge[1].z(), 1e-15);
}
TEST(SharpEdge, OfASawGoesAlongAllTeeth) {
  const std::vector<Vec3> edge = sharp_edge(saw(3), kSharp);
  ASSERT_EQ(edge.size(), 7u);
  for (const Vec3& p : edge) EXPECT_GE(p.z(), 4);
  EXPECT_NEAR(std::fabs(edge.back().x() - edge.front().x()), 6, 1e-15);
}
TEST(SharpEdge, ABoxHasNone) { EXPECT_TRUE(sharp_edge(box_mesh(Vec3(1, 1, 1), {1, 1, 1}), kSharp).empty()); }
TEST(SharpEdge, LinesThatBranchAreNone) {
  EXPECT_TRUE(sharp_edge(spike_mesh(0.1, 1, 3), std::numbers::pi / 2).empty()) << "three edges meet at its tip";
}
