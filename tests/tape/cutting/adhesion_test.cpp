#include "tape/cutting/adhesion.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <algorithm>

#include "tape/cutting/transfer.hpp"
#include "tape/effects/triangle_plane.hpp"
using namespace tape;

namespace {
constexpr Real kCut = 0.0153;   // [m] place of the cut along a strip of 30 mm
constexpr Real kBelow = -1e-4;  // [m] height of a large triangle under it
const Vec3 kSlip(2e-5, -1e-5, 0);

/// A flat strip over one large triangle that is there twice, cut across. One more vertex stands over the strip beside the kerf.
struct Over {
  StripMesh mesh = make_strip_mesh({.length = 0.03, .cells_across = 4}, 0.019, 1);
  Cut cut = cut_kerf(mesh, {{kCut, -0.02}, {kCut, 0.02}}, {}, {});
  int large = static_cast<int>(mesh.triangles.size());  ///< the large triangle, before
  int lone = static_cast<int>(mesh.rest.size()) + 3;    ///< the vertex over the strip, before
  CutInWorld world = in_world();

  void add(const StripMesh& strip, std::vector<Vec3>& x, std::vector<Index3>& triangles) const {
    for (const Vec2& p : strip.rest) x.emplace_back(p.x(), p.y(), 0);
    triangles = strip.triangles;
    const int n = static_cast<int>(x.size());
    x.insert(x.end(), {Vec3(-0.1, -0.1, kBelow), Vec3(0.2, -0.1, kBelow), Vec3(0, 0.2, kBelow), Vec3(kCut + 0.0011, 0.0013, 1e-4)});
    for (int twice = 0; twice < 2; ++twice) triangles.emplace_back(n, n + 1, n + 2);
  }
  CutInWorld in_world() const {
    CutInWorld out{.cut = cut, .old_mesh = mesh, .old_triangles = {}, .triangles = {}, .old_x = {}, .x = {}, .samples = 2};
    add(mesh, out.old_x, out.old_triangles);
    add(cut.mesh, out.x, out.triangles);
    return out;
  }
  /// Triangle of the strip under the lone vertex, which the cut takes.
  int under() const {
    std::vector<int> all(mesh.triangles.size());
    for (std::size_t t = 0; t < all.size(); ++t) all[t] = static_cast<int>(t);
    return locate(mesh, all, {kCut + 0.0011, 0.0013}).triangle;
  }
};
/// Edges of a triangle, and across them: a cohesive pair remembers its slip u as B^T u.
Mat3 basis(const std::vector<Vec3>& x, const Index3& t) {
  const Vec3 a = x[static_cast<std::size_t>(t[1])] - x[static_cast<std::size_t>(t[0])],
             b = x[static_cast<std::size_t>(t[2])] - x[static_cast<std::size_t>(t[0])];
  Mat3 B;
  B << a, b, a.cross(b);
  return B;
}
Mat3 spanned(const std::vector<Vec3>& x, int vertex, const Index3& t) {
  Mat3 D;
  for (int k = 0; k < 3; ++k) D.col(k) = x[static_cast<std::size_t>(t[k])] - x[static_cast<std::size_t>(vertex)];
  return D;
}
}  // namespace

TEST(CutAdhesion, APairOnATriangleThatIsGoneHoldsTheNextOneAsFarSlipped) {
  const Over over;
  ASSERT_EQ(over.cut.refusal, "");
  const int under = over.under();
  ASSERT_LT(over.world.new_triangle(under), 0) << "or there is nothing to move";
  EffectMemory memory;
  const Vec3 slip = basis(over.world.old_x, over.mesh.triangles[static_cast<std::size_t>(under)]).transpose() * kSlip;
  std::get<MemoryOf<Cohesion>>(memory).pairs = {{{over.lone, under}, 0.7, slip}};
  const auto pairs = std::get<MemoryOf<Cohesion>>(carried_over(over.world, memory)).pairs;
  ASSERT_EQ(pairs.size(), 1u);
  EXPECT_EQ(pairs[0].vertex, over.world.new_vertex(over.lone));
  EXPECT_EQ(pairs[0].beta, 0.7);
  const Mat3 B = basis(over.world.x, over.world.triangles[static_cast<std::size_t>(pairs[0].triangle)]);
  EXPECT_LT((B.transpose().inverse() * pairs[0].slip - kSlip).norm(), 1e-12);
}
TEST(CutAdhesion, ABondStaysAsStrained) {
  const Over over;
  const int under = over.under();
  Mat3 F = Mat3::Identity();
  F(0, 2) = 0.2, F(2, 2) = 1.1;
  const Mat3 old = spanned(over.world.old_x, over.lone, over.mesh.triangles[static_cast<std::size_t>(under)]);
  EffectMemory memory;
  std::get<MemoryOf<Bonds>>(memory).pairs = {{{over.lone, under}, 0, 9e-5, old.inverse() * F}};
  const auto pairs = std::get<MemoryOf<Bonds>>(carried_over(over.world, memory)).pairs;
  ASSERT_EQ(pairs.size(), 1u);
  const Mat3 now = spanned(over.world.x, pairs[0].vertex, over.world.triangles[static_cast<std::size_t>(pairs[0].triangle)]);
  EXPECT_LT((now * pairs[0].inverse - old * old.inverse() * F).norm(), 1e-9);
  EXPECT_NEAR(pairs[0].rest, 9e-5, 1e-12) << "over a flat strip it is as far away as before";
}
/// Engagement that is linear along the strip stays so: barycentric weights are exact.
TEST(CutAdhesion, NewVerticesHoldAsThoseAroundThemDid) {
  const Over over;
  const auto beta = [](const Vec2& p) { return 0.5 + 10 * p.x(); };
  EffectMemory memory;
  for (std::size_t v = 0; v < over.mesh.rest.size(); ++v)
    std::get<MemoryOf<Cohesion>>(memory).pairs.push_back({{static_cast<int>(v), over.large}, beta(over.mesh.rest[v]), Vec3::Zero()});
  const auto pairs = std::get<MemoryOf<Cohesion>>(carried_over(over.world, memory)).pairs;
  EXPECT_EQ(pairs.size(), over.cut.mesh.rest.size());
  int fresh = 0;
  for (const Cohesion::Memory& m : pairs) {
    EXPECT_EQ(m.triangle, over.world.new_triangle(over.large));
    EXPECT_NEAR(m.beta, beta(over.cut.mesh.rest[static_cast<std::size_t>(m.vertex)]), 1e-12);
    fresh += over.cut.parent[static_cast<std::size_t>(m.vertex)].weight.maxCoeff() < 1;
  }
  EXPECT_GT(fresh, 5);
}
/// What holds a vertex with two triangles holds a new one with each as much as with the other before.
TEST(CutAdhesion, NewVerticesHoldEachTriangleAsTheOthersDid) {
  const Over over;
  const int second = over.large + 1;
  EffectMemory memory;
  auto& held = std::get<MemoryOf<Cohesion>>(memory).pairs;
  for (int v = 0; v < static_cast<int>(over.mesh.rest.size()); ++v) {
    held.push_back({{v, over.large}, 0.9, Vec3::Zero()});
    held.push_back({{v, second}, 0.1, Vec3::Zero()});
  }
  const auto pairs = std::get<MemoryOf<Cohesion>>(carried_over(over.world, memory)).pairs;
  EXPECT_EQ(pairs.size(), 2 * over.cut.mesh.rest.size());
  for (const Cohesion::Memory& m : pairs) EXPECT_NEAR(m.beta, m.triangle == over.world.new_triangle(second) ? 0.1 : 0.9, 1e-12);
}
/// Bonds that have let go hold nothing that could be taken over.
TEST(CutAdhesion, ReleasedBondsAreNotTakenOver) {
  const Over over;
  EffectMemory memory;
  for (int v = 0; v < static_cast<int>(over.mesh.rest.size()); ++v) {
    const Mat3 old = spanned(over.world.old_x, v, over.world.old_triangles[static_cast<std::size_t>(over.large)]);
    const bool released = over.mesh.rest[static_cast<std::size_t>(v)].y() > 0;
    std::get<MemoryOf<Bonds>>(memory).pairs.push_back({{v, over.large}, released ? 5 : 0, 9e-5, old.inverse()});
  }
  int fresh = 0;
  const auto pairs = std::get<MemoryOf<Bonds>>(carried_over(over.world, memory)).pairs;
  for (const Bonds::Memory& m : pairs) {
    if (over.cut.parent[static_cast<std::size_t>(m.vertex)].weight.maxCoeff() == 1) continue;
    EXPECT_EQ(m.cooldown, 0);
    ++fresh;
  }
  EXPECT_GT(fresh, 1);
}
TEST(CutAdhesion, NewSamplesAreAsFarOpenAndSlipped) {
  const Over over;
  const auto plane = [&](const std::vector<Vec3>& x, const std::vector<Index3>& triangles, int sample, int triangle, const Real(&foot)[3]) {
    Vec3 corners[6];
    for (int k = 0; k < 3; ++k) {
      corners[k] = x[static_cast<std::size_t>(triangles[static_cast<std::size_t>(sample / 4)][k])];
      corners[3 + k] = x[static_cast<std::size_t>(triangles[static_cast<std::size_t>(triangle)][k])];
    }
    Real w[3];
    sample_weights(sample % 4, 2, w);
    return TrianglePlane<6>(corners, w, foot);
  };
  EffectMemory memory;
  auto& before = std::get<MemoryOf<CohesiveZone>>(memory).pairs;
  for (int sample = 0; sample < 4 * over.large; ++sample) {
    CohesiveZone::Memory m{{sample, over.large}, {0.3, 0.3, 0.4}, {0, 0}, 1.5e-5, 1};
    const auto at = plane(over.world.old_x, over.world.old_triangles, sample, over.large, m.foot);
    for (int a = 0; a < 2; ++a) m.met[a] = at.along()[a] - at.e[a].dot(kSlip);
    before.push_back(m);
  }
  const auto after = std::get<MemoryOf<CohesiveZone>>(carried_over(over.world, memory)).pairs;
  EXPECT_EQ(after.size(), 4 * over.cut.mesh.triangles.size());
  EXPECT_TRUE(std::ranges::is_sorted(after, {}, [](const auto& m) { return m.key(); }));
  for (const CohesiveZone::Memory& m : after) {
    EXPECT_EQ(m.worst, 1.5e-5);
    const auto at = plane(over.world.x, over.world.triangles, m.sample, m.triangle, m.foot);
    const Vec2 slipped = at.metric().inverse() * (at.along() - Vec2(m.met[0], m.met[1]));
    EXPECT_LT((slipped[0] * at.e[0] + slipped[1] * at.e[1] - kSlip).norm(), 1e-12);
  }
}
