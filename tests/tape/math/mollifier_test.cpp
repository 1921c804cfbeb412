#include "tape/math/mollifier.hpp"

#include <gtest/gtest.h>
using namespace tape;

TEST(Mollifier, ParallelEdgesHaveNoWeight) { EXPECT_EQ(edge_edge_mollifier(0, 1e-12).value, 0); }
TEST(Mollifier, ValueAndSlopeGoOnAcrossTheThreshold) {
  constexpr Real kEps = 3e-14;
  const Jet below = edge_edge_mollifier(kEps * (1 - 1e-9), kEps), at = edge_edge_mollifier(kEps, kEps);
  EXPECT_EQ(at.value, 1);
  EXPECT_EQ(at.slope, 0);
  EXPECT_NEAR(below.value, 1, 1e-12);
  EXPECT_NEAR(below.slope * kEps, 0, 1e-8);
}
TEST(Mollifier, HalfwayItIsThreeQuarters) {  // 2 r - r^2 at r = 1/2; slope (2 - 2 r)/eps, curvature -2/eps^2
  const Jet m = edge_edge_mollifier(0.5, 1);
  EXPECT_DOUBLE_EQ(m.value, 0.75);
  EXPECT_DOUBLE_EQ(m.slope, 1);
  EXPECT_DOUBLE_EQ(m.curvature, -2);
}
