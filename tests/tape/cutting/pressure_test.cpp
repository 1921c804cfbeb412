#include "tape/cutting/pressure.hpp"

#include <gtest/gtest.h>

#include <vector>

using namespace tape;

namespace {
// Two triangles of a strip (vertices 0-3), and a blade above: vertices 4, 5 are its sharp edge, 6 its back.
const std::vector<Index3> kTriangles{{0, 1, 2}, {0, 2, 3}};
const std::vector<Real> kArea{6e-6, 3e-6};  // [m^2]
const std::vector<char> kSharp{0, 0, 0, 0, 1, 1, 0};
const std::vector<Vec3> kAt{{0, 0, 0},          {4e-3, 0, 0},         {4e-3, 3e-3, 0},   {0, 3e-3, 0},
                            {3e-3, 1e-3, 1e-4}, {3e-3, 2.9e-3, 1e-4}, {3e-3, 1e-3, 5e-3}};

ContactPair pair(PairKind kind, int a, int b, int c, int d) {
  ContactPair p{};
  p.v[0] = a, p.v[1] = b, p.v[2] = c, p.v[3] = d;
  p.kind = kind;
  return p;
}
ContactPair point(int a, int b, int c, int d) { return pair(PairKind::vertex_triangle, a, b, c, d); }
ContactPair edges(int a, int b, int c, int d) { return pair(PairKind::edge_edge, a, b, c, d); }
BladePressure pressure(const std::vector<ContactPair>& pairs, const std::vector<Real>& force, Real threshold = 1e3) {
  return BladePressureProbe(kTriangles, kArea, kSharp).measure(pairs, force, kAt, threshold);
}
}  // namespace

TEST(BladePressure, ASharpVertexLoadsTheAreaOfItsTriangle) {
  const BladePressure p = pressure({point(4, 0, 1, 2)}, {0.012});
  EXPECT_DOUBLE_EQ(p.peak, 0.012 / 6e-6);
  EXPECT_EQ(p.triangle, 0);
  EXPECT_EQ(p.above, std::vector<int>{0});
}
TEST(BladePressure, ASharpEdgeLoadsAThirdOfTheTrianglesAtTheEdge) {
  const BladePressure p = pressure({edges(2, 0, 4, 5)}, {0.012});
  EXPECT_DOUBLE_EQ(p.peak, 0.012 / 3e-6);
  EXPECT_EQ(p.above, (std::vector<int>{0, 1}));
  EXPECT_DOUBLE_EQ(pressure({edges(4, 5, 2, 1)}, {0.012}).peak, 0.012 / 2e-6);  // a rim edge has one triangle
}
TEST(BladePressure, AVertexUnderASharpTriangleHasAThirdOfItsTriangles) {
  // The closest point to vertex 2 of the blade's triangle 4-5-6 is on its edge 4-5: all of the force is on sharp vertices.
  const BladePressure p = pressure({point(2, 4, 5, 6)}, {0.012});
  EXPECT_DOUBLE_EQ(p.peak, 0.012 / 3e-6);
  EXPECT_EQ(p.above, (std::vector<int>{0, 1}));
}
TEST(BladePressure, ForcesOnOneElementAddUpAndThoseOnOthersDoNot) {
  const BladePressure p = pressure({point(4, 0, 1, 2), point(5, 2, 0, 1), point(4, 0, 2, 3)}, {0.003, 0.006, 0.001});
  EXPECT_DOUBLE_EQ(p.peak, 0.009 / 6e-6);
  EXPECT_EQ(p.triangle, 0);
  EXPECT_EQ(p.above, std::vector<int>{0});
}
TEST(BladePressure, BluntPartsDoNotCount) {
  const BladePressure p = pressure({point(6, 0, 1, 2), edges(0, 1, 2, 3)}, {5, 5});
  EXPECT_EQ(p.peak, 0);
  EXPECT_EQ(p.triangle, -1);
  EXPECT_TRUE(p.above.empty());
}
TEST(BladePressure, OfAnEdgeWithOneSharpEndTheShareOfThatEndCounts) {
  // Edge 1-2 passes edge 4-6 nearest at its lower end, vertex 4: sharp. Edge 5-6 from vertex 1 lies nearest in between.
  const BladePressure at_end = pressure({edges(1, 2, 4, 6)}, {0.01});
  EXPECT_DOUBLE_EQ(at_end.peak, 0.01 / 2e-6);
  std::vector<Vec3> x = kAt;
  x[5] = {3e-3, 1e-3, -4e-3}, x[6] = {3e-3, 1e-3, 12e-3};  // the height of the strip is a quarter of the way up
  const BladePressure between = BladePressureProbe(kTriangles, kArea, kSharp).measure({edges(1, 2, 5, 6)}, {0.01}, x, 1e3);
  EXPECT_NEAR(between.peak, 0.75 * 0.01 / 2e-6, 1e-9);
}
TEST(BladePressure, TheThresholdItselfIsAbove) {
  EXPECT_EQ(pressure({point(4, 0, 1, 2)}, {6e-3}, 1e3).above.size(), 1u);
  EXPECT_EQ(pressure({point(4, 0, 1, 2)}, {5.99e-3}, 1e3).above.size(), 0u);
}

TEST(CutTrigger, TwoStepsOnEndCutAndACooldownFollows) {
  CutTrigger watch;
  const TriggerParams params;
  std::vector<int> cuts;
  const Real pressure[] = {2e3, 0, 2e3, 1e3, 5e3, 5e3, 5e3, 5e3, 5e3, 0, 999, 1e3, 1e3};
  for (int step = 0; step < 13; ++step)
    if (watch.update(pressure[step], params)) cuts.push_back(step);
  EXPECT_EQ(cuts, (std::vector<int>{3, 8}));  // 4, 5, 6 are the cooldown; so are 9, 10, 11
}
TEST(CutTrigger, StepsAndCooldownCanBeSet) {
  CutTrigger watch;
  int cuts = 0;
  for (int step = 0; step < 12; ++step) cuts += watch.update(2e3, {.threshold = 2e3, .steps = 1, .cooldown = 0});
  EXPECT_EQ(cuts, 12);
  EXPECT_THROW(require_valid(TriggerParams{.threshold = 0}, "cut"), SettingsError);
  EXPECT_THROW(require_valid(TriggerParams{.steps = 0}, "cut"), SettingsError);
}
