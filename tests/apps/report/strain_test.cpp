#include "apps/report/strain.hpp"

#include <gtest/gtest.h>

#include <cmath>

using namespace tape;
using namespace tape::report;

TEST(VertexStrain, APureStretchIsHalfOfItsSquareLessOne) {
  const Real stretch = 1.1;
  EXPECT_NEAR(largest_strain({{0, 0}, {1, 0}, {0, 1}}, {{0, 0, 3}, {0, stretch, 3}, {1, 0, 3}}), (stretch * stretch - 1) / 2, 1e-15);
}
TEST(VertexStrain, AShearOfGammaHasTheEigenvaluesOfItsStrainTensor) {
  const Real gamma = 0.2;  // F = [1 gamma; 0 1], E = [0 gamma; gamma gamma^2] / 2
  const Real expected = gamma * gamma / 4 + std::sqrt(std::pow(gamma * gamma / 4, 2) + gamma * gamma / 4);
  EXPECT_NEAR(largest_strain({{0, 0}, {1, 0}, {0, 1}}, {{0, 0, 0}, {1, 0, 0}, {gamma, 1, 0}}), expected, 1e-15);
}
TEST(VertexStrain, AVertexTakesTheLargestOfItsTrianglesAndBodiesHaveNone) {
  const std::vector<Vec2> rest = {{0, 0}, {1, 0}, {0, 1}, {-1, 0}, {0, 0}};
  const std::vector<Vec3> x = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {-1.2, 0, 0}, {9, 9, 9}};
  const std::vector<Real> strain = vertex_strain({{0, 1, 2}, {0, 2, 3}}, rest, x, 4);
  EXPECT_EQ(strain[1], 0);
  EXPECT_NEAR(strain[0], (1.44 - 1) / 2, 1e-15);
  EXPECT_TRUE(std::isnan(strain[4]));
}
