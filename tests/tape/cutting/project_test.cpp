#include "tape/cutting/project.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

using namespace tape;
using testing::HasSubstr;

namespace {
constexpr Real kWidth = 0.019, kLength = 0.06, kPi = std::numbers::pi;  // [m]

StripMesh strip(MeshPattern pattern = MeshPattern::same) {
  return make_strip_mesh({.length = kLength, .cells_across = 6, .pattern = pattern}, kWidth, 3);
}
std::vector<Vec3> placed(const StripMesh& mesh, const std::function<Vec3(const Vec2&)>& at) {
  std::vector<Vec3> x;
  for (const Vec2& p : mesh.rest) x.push_back(at(p));
  return x;
}
/// The triangle whose centroid is nearest to a rest point.
int triangle_at(const StripMesh& mesh, const Vec2& p) {
  int nearest = 0;
  const auto distance = [&](int t) { return (corners(mesh, t).centre() - p).norm(); };
  for (int t = 1; t < static_cast<int>(mesh.triangles.size()); ++t)
    if (distance(t) < distance(nearest)) nearest = t;
  return nearest;
}
Real distance_from_line(const Vec2& p, const Vec2& a, const Vec2& b) {
  const Vec2 along = (b - a).normalized(), from = p - a;
  return std::fabs(along.x() * from.y() - along.y() * from.x());
}
}  // namespace

TEST(ProjectBlade, OnARigidlyMovedStripTheLineIsTheBladeMovedBack) {
  const Pose pose{Eigen::AngleAxisd(0.7, Vec3(1, 2, -1).normalized()).toRotationMatrix(), {0.3, -0.2, 1}};
  const std::vector<Vec2> wanted{{0.031, -0.02}, {0.033, -0.004}, {0.03, 0.003}, {0.034, 0.02}};
  for (MeshPattern pattern : {MeshPattern::same, MeshPattern::alternating, MeshPattern::crossed, MeshPattern::irregular}) {
    const StripMesh mesh = strip(pattern);
    const auto lifted = [&](const Vec2& p, Real height) { return apply(pose, Vec3(p.x(), p.y(), height)); };
    std::vector<Vec3> blade;
    for (const Vec2& p : wanted) blade.push_back(lifted(p, -2e-4));
    const Projection found =
        project_blade(mesh, placed(mesh, [&](const Vec2& p) { return lifted(p, 0); }), blade, {triangle_at(mesh, wanted[1])}, 1e-3, {});
    ASSERT_TRUE(found) << found.refusal;
    EXPECT_LT((found.normal - pose.rotation.col(2)).norm(), 1e-12);
    for (const Vec2& p : found.line) EXPECT_LT(distance_to_line(p, wanted), 1e-8);
    for (const Vec2& p : {wanted[1], wanted[2]}) EXPECT_LT(distance_to_line(p, found.line), 1e-12);
    // It goes past both edges by the overshoot along the blade.
    const Vec2 exit = wanted[1] + (wanted[0] - wanted[1]) * ((kWidth / 2 - 0.004) / 0.016);
    EXPECT_NEAR((found.line.front() - exit).norm(), 1e-3, 1e-8);
  }
}
TEST(ProjectBlade, ALineThroughVerticesAndAlongEdgesIsWhole) {
  const StripMesh mesh = strip();
  const std::vector<Vec3> x = placed(mesh, [](const Vec2& p) { return Vec3(p.x(), p.y(), 0); });
  const Real cell = kWidth / 6;
  const Vec3 corner(9 * cell, -kWidth / 2, 1e-4);
  for (const Vec3& along : {Vec3(0, kWidth, 0), Vec3(kWidth, kWidth, 0), Vec3(-kWidth, kWidth, 0), Vec3(2 * kWidth, kWidth, 0)})
    for (Real beside : {0.0, 1e-15, -1e-12}) {
      const Vec3 start = corner + Vec3(beside, 0, 0);
      const Projection found = project_blade(mesh, x, {start, start + along}, {triangle_at(mesh, start.head<2>())}, 1e-3, {});
      ASSERT_TRUE(found) << found.refusal;
      for (const Vec2& p : found.line) EXPECT_LT(distance_from_line(p, start.head<2>(), (start + along).head<2>()), 1e-9);
      for (std::size_t i = 0; i + 1 < found.line.size(); ++i) EXPECT_GT((found.line[i + 1] - found.line[i]).dot(along.head<2>()), 0);
      EXPECT_LT((found.line.front() - start.head<2>()).norm(), 1e-5);
      const Real inside = along.x() > 0 ? std::min(1.0, (kLength - start.x()) / along.x()) : 1.0;
      EXPECT_LT((found.line.back() - (start + inside * along).head<2>()).norm(), 1e-3 + 1e-5);
    }
}
TEST(ProjectBlade, TwoTrianglesAtAnEdgeUnderTheBladeCountOnce) {
  // All numbers are exact: the row of edges at y = 0 belongs to the triangles on both sides.
  const StripMesh mesh = strip();
  const std::vector<Vec3> x = placed(mesh, [](const Vec2& p) { return Vec3(p.x(), p.y(), 0); });
  const Projection found = project_blade(mesh, x, {{0.01, 0, 0}, {0.05, 0, 0}}, {triangle_at(mesh, {0.03, 0})}, 1e-3, {});
  ASSERT_TRUE(found) << found.refusal;
  EXPECT_NEAR(found.line.front().x(), 0.01, 1e-15);
  EXPECT_NEAR(found.line.back().x(), 0.05, 1e-15);
  for (std::size_t i = 0; i + 1 < found.line.size(); ++i) EXPECT_LT(found.line[i].x(), found.line[i + 1].x());
}
TEST(ProjectBlade, OnAStretchedStripTheLineIsInRestCoordinates) {
  const StripMesh mesh = strip();
  const std::vector<Vec3> x = placed(mesh, [](const Vec2& p) { return Vec3(1.2 * p.x(), 0.9 * p.y(), 0); });
  const Projection found = project_blade(mesh, x, {{0.036, -0.003, 1e-4}, {0.036, 0.006, 1e-4}}, {triangle_at(mesh, {0.03, 0})}, 1e-3, {});
  ASSERT_TRUE(found) << found.refusal;
  EXPECT_LT((found.line.front() - Vec2(0.03, -0.003 / 0.9)).norm(), 1e-12);  // it ends within the strip: no overshoot
  EXPECT_LT((found.line.back() - Vec2(0.03, 0.006 / 0.9)).norm(), 1e-12);
}
TEST(ProjectBlade, OnAnArchTheLineAcrossIsStraight) {
  // Half a circle of radius r about y: rest x = r a. The blade touches the top.
  const Real r = kLength / kPi;
  const StripMesh mesh = strip(MeshPattern::alternating);
  const std::vector<Vec3> x = placed(mesh, [&](const Vec2& p) { return Vec3(-r * std::cos(p.x() / r), p.y(), r * std::sin(p.x() / r)); });
  const Projection found =
      project_blade(mesh, x, {{0, -0.02, r + 1e-4}, {0, 0.02, r + 1e-4}}, {triangle_at(mesh, {kLength / 2, 0})}, 1e-3, {});
  ASSERT_TRUE(found) << found.refusal;
  for (const Vec2& p : found.line) EXPECT_NEAR(p.x(), kLength / 2, 1e-4);
  EXPECT_NEAR(found.line.front().y(), -kWidth / 2 - 1e-3, 1e-8);
  EXPECT_NEAR(found.line.back().y(), kWidth / 2 + 1e-3, 1e-8);
}
TEST(ProjectBlade, OfTwoLayersOnlyTheTargetedOneIsFollowed) {
  // A U: 26 mm out, an arc of 8 mm, 26 mm back 2.55 mm above. The blade lies 13 mm from the bend.
  const Real flat = 0.026, r = (kLength - 2 * flat) / kPi;
  const StripMesh mesh = strip();
  const std::vector<Vec3> x = placed(mesh, [&](const Vec2& p) {
    if (p.x() <= flat) return Vec3(p.x(), p.y(), 0);
    if (p.x() >= kLength - flat) return Vec3(kLength - p.x(), p.y(), 2 * r);
    return Vec3(flat + r * std::sin((p.x() - flat) / r), p.y(), r - r * std::cos((p.x() - flat) / r));
  });
  const std::vector<Vec3> blade{{0.013, -0.02, 2 * r + 1e-4}, {0.013, 0.02, 2 * r + 1e-4}};
  for (Real at : {0.013, kLength - 0.013}) {
    const Projection found = project_blade(mesh, x, blade, {triangle_at(mesh, {at, 0})}, 1e-3, {});
    ASSERT_TRUE(found) << found.refusal;
    for (const Vec2& p : found.line) EXPECT_NEAR(p.x(), at, 1e-9);
  }
}
TEST(ProjectBlade, AFoldUnderTheBladeIsRefused) {
  // Folded flat onto itself across its length, and the blade lies along it over the fold.
  const StripMesh mesh = strip();
  const std::vector<Vec3> x =
      placed(mesh, [](const Vec2& p) { return Vec3(std::min(p.x(), kLength - p.x()), p.y(), p.x() > kLength / 2 ? 4e-4 : 0.0); });
  const Projection found = project_blade(mesh, x, {{0.02, 0, 6e-4}, {0.04, 0.001, 6e-4}}, {triangle_at(mesh, {0.031, 0})}, 1e-3, {});
  EXPECT_THAT(found.refusal, HasSubstr("folded"));
  EXPECT_TRUE(found.line.empty());
}
TEST(ProjectBlade, AWallUnderTheBladeIsRefusedAndASlopeIsNot) {
  // Flat, one cell down, flat again; the blade lies along the strip over the step.
  const StripMesh mesh = strip();
  const Real cell = kWidth / 6;
  const auto projected = [&](Real run) {  // horizontal part of the cell that goes down [cells]
    const std::vector<Vec3> x = placed(mesh, [&](const Vec2& p) {
      const Real down = std::clamp(p.x() - 9 * cell, 0.0, cell);
      return Vec3(p.x() - (1 - run) * down, p.y(), -std::sqrt(1 - run * run) * down);
    });
    return project_blade(mesh, x, {{0.02, 1e-3, 1e-4}, {0.04, 0, 1e-4}}, {triangle_at(mesh, {0.025, 0})}, 1e-3, {});
  };
  for (Real run : {0.0, 1e-12, 0.05, -0.2}) EXPECT_THAT(projected(run).refusal, HasSubstr("folded")) << run;
  EXPECT_EQ(projected(0.4).refusal, "");  // the plane tilts with the slope, so the sine is more than that
}
TEST(ProjectBlade, AHelixThatLiesUnderTheBladeTwiceIsRefused) {
  // A turn and a half of a flat spiral staircase that is as steep as it can be without standing on edge.
  const StripMesh mesh = make_strip_mesh({.length = 0.3, .cells_across = 6}, kWidth, 1);
  const Real r = 0.03;
  const std::vector<Vec3> x = placed(mesh, [&](const Vec2& p) {
    const Real a = p.x() / r;
    return Vec3((r - p.y()) * std::sin(a), (r - p.y()) * -std::cos(a), 1e-3 * a);
  });
  const Projection found =
      project_blade(mesh, x, {{0.018, 0, 5e-3}, {0.042, 0, 5e-3}}, {triangle_at(mesh, {r * kPi / 2, 0})}, 1e-3, {.reach = 0.05});
  EXPECT_THAT(found.refusal, HasSubstr("more than once"));
}
TEST(ProjectBlade, TwoStrandsBesideEachOtherAreRefusedAndOneOfThemIsNot) {
  // Out, and back beside itself; the blade lies across both.
  const StripMesh mesh = strip();
  const std::vector<Vec3> x = placed(
      mesh, [](const Vec2& p) { return p.x() < kLength / 2 ? Vec3(p.x(), p.y(), 0) : Vec3(kLength - p.x(), kWidth + 1e-3 - p.y(), 0); });
  const std::vector<Vec3> blade{{0.013, -0.02, 1e-4}, {0.013, 0.04, 1e-4}};
  const int out = triangle_at(mesh, {0.013, 0}), back = triangle_at(mesh, {kLength - 0.013, 0});
  EXPECT_THAT(project_blade(mesh, x, blade, {out, back}, 1e-3, {}).refusal, HasSubstr("beside itself"));
  for (int target : {out, back}) {
    const Projection found = project_blade(mesh, x, blade, {target}, 1e-3, {});
    ASSERT_TRUE(found) << found.refusal;
    for (const Vec2& p : found.line) EXPECT_NEAR(p.x(), target == out ? 0.013 : kLength - 0.013, 1e-9);
  }
}
TEST(ProjectBlade, AnEdgeOnBladeIsRefused) {
  const StripMesh mesh = strip();
  const std::vector<Vec3> x = placed(mesh, [](const Vec2& p) { return Vec3(p.x(), p.y(), 0); });
  const int target = triangle_at(mesh, {0.03, 0});
  EXPECT_THAT(project_blade(mesh, x, {{0.03, 0, 1e-4}, {0.031, 0, 0.01}}, {target}, 1e-3, {}).refusal, HasSubstr("edge-on"));
  EXPECT_THAT(project_blade(mesh, x, {{0.03, 0, 0.02}, {0.031, 0, 0.02}}, {target}, 1e-3, {}).refusal, HasSubstr("not near"));
  EXPECT_THAT(project_blade(mesh, x, {{0.061, -0.01, 1e-4}, {0.061, 0.01, 1e-4}}, {triangle_at(mesh, {0.06, 0})}, 1e-3, {}).refusal,
              HasSubstr("not over"));
}
TEST(ProjectBlade, TapeFartherThanTheReachIsNotCut) {
  // The strip bends down along y beyond y = 0, away from a long blade; 5 mm below it ends the cut.
  const StripMesh mesh = make_strip_mesh({.length = kLength, .cells_across = 24}, kWidth, 1);
  const std::vector<Vec3> x = placed(mesh, [](const Vec2& p) { return Vec3(p.x(), p.y(), p.y() > 0 ? -p.y() : 0.0); });
  std::vector<Vec3> blade{{0.03, -0.02, 1e-4}, {0.03, 0.02, 1e-4}};
  for (int run = 0; run < 2; ++run) {
    const Projection found = project_blade(mesh, x, blade, {triangle_at(mesh, {0.03, -0.005})}, 0.01, {.reach = 3e-3});
    ASSERT_TRUE(found) << found.refusal;
    const Vec2 end = run == 0 ? found.line.back() : found.line.front();
    EXPECT_GT(end.y(), 2.5e-3);
    EXPECT_LT(end.y(), 4.5e-3);  // a cell or two more, and no overshoot
    std::reverse(blade.begin(), blade.end());
  }
}
TEST(ProjectBlade, WrongInputIsAnError) {
  const StripMesh mesh = strip();
  EXPECT_THROW(project_blade(mesh, {}, {{0, 0, 0}, {1, 0, 0}}, {0}, 1e-3, {}), InputError);
  const std::vector<Vec3> x(mesh.rest.size(), Vec3::Zero());
  EXPECT_THROW(project_blade(mesh, x, {{0, 0, 0}, {std::nan(""), 0, 0}}, {0}, 1e-3, {}), InputError);
  EXPECT_THROW(project_blade(mesh, x, {{0, 0, 0}, {1, 0, 0}}, {0}, 1e-3, {.reach = 0}), SettingsError);
}
