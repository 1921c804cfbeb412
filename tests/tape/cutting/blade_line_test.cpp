#include "tape/cutting/blade_line.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

using namespace tape;

TEST(BladeLine, SimplifiedKeepsEveryCornerWithinTheTolerance) {
  Line arc;
  for (int k = 0; k <= 100; ++k) arc.push_back({std::cos(0.02 * k), std::sin(0.02 * k)});
  for (Real tolerance : {1e-1, 1e-2, 1e-3}) {
    const Line line = simplified(arc, tolerance);
    EXPECT_LE(deviation(arc, line), tolerance);
    EXPECT_EQ(line.front(), arc.front());
    EXPECT_EQ(line.back(), arc.back());
    EXPECT_LT(line.size(), 3 + 2 / std::sqrt(8 * tolerance) * 2);  // a chord of sagitta s on radius 1 spans sqrt(8 s)
  }
  EXPECT_EQ(simplified({{0, 0}, {1, 1e-6}, {2, 0}}, 1e-5).size(), 2u);
  EXPECT_EQ(simplified({{0, 0}, {1, 1e-4}, {2, 0}}, 1e-5).size(), 3u);
}
TEST(BladeLine, AveragedLeavesAStraightLineAndFlattensTeeth) {
  const Line straight{{0, 0}, {1, 0.5}, {4, 2}};
  EXPECT_LT(deviation(averaged(straight, 0.7), {{0, 0}, {4, 2}}), 1e-14);
  Line teeth;  // sides of length 1 at 45 degrees: a window of 2 holds one whole tooth, whose mean is half its height
  for (int k = 0; k <= 20; ++k) teeth.push_back({k / std::sqrt(2), (k % 2) / std::sqrt(2)});
  for (const Vec2& p : averaged(teeth, 2)) {
    if (p.x() < std::sqrt(2) || p.x() > 18 / std::sqrt(2)) continue;
    EXPECT_NEAR(p.y(), std::sqrt(0.125), 1e-12);
  }
  Real highest = 0;  // a window of 1 on a tip has half a side on each side of it, a quarter of the height below it in the mean
  for (const Vec2& p : averaged(teeth, 1))
    if (p.x() > std::sqrt(2) && p.x() < 18 / std::sqrt(2)) highest = std::max(highest, p.y());
  EXPECT_NEAR(highest, 0.75 / std::sqrt(2), 1e-12);
}
