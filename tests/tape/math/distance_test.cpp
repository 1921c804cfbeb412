#include "tape/math/distance.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include "tape/math/rotation.hpp"
using namespace tape;

namespace {
using Stencil = Vec3[4];
using Closest4 = Closest (*)(const Stencil&);

Real distance2(Closest4 closest, const Stencil& x) { return combine(closest(x).weight, x).squaredNorm(); }

/// Claims of Closest that hold for every stencil: weights sum to +1 and -1 over the two sides and are convex, slopes to 0.
void expect_well_formed(const Closest& c, int firsts) {
  Real side[2] = {0, 0};
  for (int i = 0; i < 4; ++i) {
    side[i >= firsts] += c.weight[i];
    const Real towards = i < firsts ? c.weight[i] : -c.weight[i];
    EXPECT_GE(towards, -1e-12);
    EXPECT_LE(towards, 1 + 1e-12);
  }
  EXPECT_NEAR(side[0], 1, 1e-12);
  EXPECT_NEAR(side[1], -1, 1e-12);
  for (int k = 0; k < c.free; ++k) EXPECT_NEAR(c.slope[k][0] + c.slope[k][1] + c.slope[k][2] + c.slope[k][3], 0, 1e-12);
}
/// The closest point of the triangle (-1,0,1), (1,0,1), (0,0,-1) to a point of its plane, by regions of the plane y = 0.
Real in_plane_distance(Real x, Real z) {
  const auto to_segment = [&](Real ax, Real az, Real bx, Real bz) {
    const Real ex = bx - ax, ez = bz - az;
    const Real f = std::clamp(((x - ax) * ex + (z - az) * ez) / (ex * ex + ez * ez), 0.0, 1.0);
    return std::hypot(x - ax - f * ex, z - az - f * ez);
  };
  const bool inside = z <= 1 && 2 * x - z <= 1 && -2 * x - z <= 1;
  return inside ? 0 : std::min({to_segment(-1, 1, 1, 1), to_segment(1, 1, 0, -1), to_segment(0, -1, -1, 1)});
}
void expect_gradient(Closest4 closest, const Stencil& x, const std::string& what, Real h = 1e-6) {
  const Closest c = closest(x);
  const Vec3 p = combine(c.weight, x);
  const Real d = p.norm();
  ASSERT_TRUE(std::isfinite(d)) << what;
  for (int i = 0; i < 4; ++i)
    for (int k = 0; k < 3; ++k) {
      Stencil plus{x[0], x[1], x[2], x[3]}, minus{x[0], x[1], x[2], x[3]};
      plus[i][k] += h, minus[i][k] -= h;
      const Real slope = (std::sqrt(distance2(closest, plus)) - std::sqrt(distance2(closest, minus))) / (2 * h);
      EXPECT_NEAR(c.weight[i] * p[k] / d, slope, 1e-5) << what << ", vertex " << i << " axis " << k;
    }
}
}  // namespace

TEST(Distance, VertexTriangleIsExactAtVerticesEdgesAndOffsets) {  // checks.md part 2
  const Real offsets[] = {0, 1e-12, 1e-4, 1, 2, 11, 1000};
  // Points of the triangle and an outward direction in its plane, so that the offset from them is the distance in the plane.
  const Real root5 = std::sqrt(5.0);
  struct Place {
    Real x, z, out_x, out_z;
  };
  const Place places[] = {{-1, 1, -1 / std::numbers::sqrt2, 1 / std::numbers::sqrt2},
                          {1, 1, 1 / std::numbers::sqrt2, 1 / std::numbers::sqrt2},
                          {0, -1, 0, -1},
                          {0, 1, 0, 1},
                          {0.5, 0, 2 / root5, -1 / root5},
                          {-0.5, 0, -2 / root5, -1 / root5},
                          {-0.3, 1, 0, 1}};
  for (const Real y : {-10.0, -1.0, -1e-12, 0.0, 1e-12, 1.0, 10.0})
    for (const Place& at : places)
      for (const Real offset : offsets) {
        const Vec3 p(at.x + offset * at.out_x, y, at.z + offset * at.out_z);
        const Stencil x{p, {-1, 0, 1}, {1, 0, 1}, {0, 0, -1}};
        const Real exact = y * y + offset * offset, found = distance2(closest_vertex_triangle, x);
        EXPECT_LE(std::fabs(found - exact), 1e-12 * std::max(1.0, exact)) << p.transpose();
        expect_well_formed(closest_vertex_triangle(x), 1);
      }
}

TEST(Distance, VertexTriangleIsTheDistanceToItsPlaneOrRimEverywhere) {
  for (Real y : {-1.0, -1e-12, 0.0, 1e-4})
    for (Real px = -2.05; px < 2.1; px += 0.1)
      for (Real pz = -2.05; pz < 2.1; pz += 0.1) {
        const Stencil x{{px, y, pz}, {-1, 0, 1}, {1, 0, 1}, {0, 0, -1}};
        const Real in_plane = in_plane_distance(px, pz), exact = y * y + in_plane * in_plane;
        EXPECT_LE(std::fabs(distance2(closest_vertex_triangle, x) - exact), 1e-12 * std::max(1.0, exact)) << px << " " << y << " " << pz;
      }
}

TEST(Distance, EdgesAtAHeightAreThatFarApart) {  // checks.md part 2: the heights
  for (const Real y : {-10.0, -1.0, -1e-12, 0.0, 1e-12, 1.0, 10.0}) {
    const Stencil crossing{{-1, y, 0}, {1, y, 0}, {0, 0, -1}, {0, 0, 1}};
    EXPECT_LE(std::fabs(distance2(closest_edge_edge, crossing) - y * y), 1e-12 * std::max(1.0, y * y));
    const Stencil parallel{{-1, y, 0}, {1, y, 0}, {-0.5, 0, 0}, {2, 0, 0}};
    EXPECT_LE(std::fabs(distance2(closest_edge_edge, parallel) - y * y), 1e-12 * std::max(1.0, y * y));
    for (const Real beyond : {0.0, 1e-12, 1e-4, 1.0, 2.0, 11.0, 1000.0}) {
      const Stencil past{{1 + beyond, y, 0}, {5000, y, 0}, {-1, 0, 0}, {1, 0, 0}};
      const Real exact = y * y + beyond * beyond;
      EXPECT_LE(std::fabs(distance2(closest_edge_edge, past) - exact), 1e-12 * std::max(1.0, exact));
      expect_well_formed(closest_edge_edge(past), 2);
    }
  }
}

TEST(Distance, CollinearEdgesAreTheirGapApartAndTheGradientPointsAlong) {
  for (const Real gap : {0.0, 0.01, 0.1, 1.0}) {
    const Vec3 along = Vec3(1, 2, -2) / 3;
    const Stencil x{-along, Vec3::Zero(), gap * along, (gap + 1) * along};
    EXPECT_NEAR(std::sqrt(distance2(closest_edge_edge, x)), gap, 1e-12);
    for (Real w : closest_edge_edge(x).weight) EXPECT_TRUE(std::isfinite(w));
    if (gap > 0) expect_gradient(closest_edge_edge, x, "collinear");
  }
}

TEST(Distance, NearlyParallelEdgesHaveTheExactDistanceAndItsSlope) {  // checks.md part 2: 1e-6 .. 1e2 degrees
  for (Real degrees = 1e-6; degrees <= 100; degrees *= 10)
    for (const Real height : {1e-4, 1.0}) {
      const Real angle = degrees * std::numbers::pi / 180;
      const Vec3 e(std::cos(angle), 0, std::sin(angle)), turn(0.3, -0.7, 0.5);
      Stencil x{{-0.7, height, 0}, {1.9, height, 0}, -0.4 * e, 1.7 * e};  // they cross at x = z = 0
      for (Vec3& p : x) p = rotate(turn, p);
      const Closest c = closest_edge_edge(x);
      expect_well_formed(c, 2);
      const Vec3 p = combine(c.weight, x);
      EXPECT_NEAR(p.norm(), height, 1e-12) << degrees;
      // The gradient is the direction of the offset times the weights, at any angle.
      EXPECT_LT(p.normalized().cross(rotate(turn, Vec3(0, 1, 0))).norm(), 1e-5) << degrees;
      // Rounding of the coordinates alone moves the crossing by this much; and a difference step h by h height / angle^2.
      const Real moved = 1e-15 * height / (angle * angle) + 1e-15 / angle;
      const Real crossing[] = {1.9 / 2.6, 0.7 / 2.6, -1.7 / 2.1, -0.4 / 2.1};
      for (int i = 0; i < 4 && moved < 0.1; ++i) EXPECT_NEAR(c.weight[i], crossing[i], 1e-8 + moved) << degrees;
      if (1e-9 * height < 1e-3 * angle * angle) expect_gradient(closest_edge_edge, x, std::to_string(degrees) + " degrees", 1e-9);
      const Stencil shifted{{-1, height, 0}, {1, height, 0}, Vec3(1.5, 0, 0.2), Vec3(1.5, 0, 0.2) + e};  // beyond the end
      expect_gradient(closest_edge_edge, shifted, "shifted, " + std::to_string(degrees) + " degrees");
    }
}

TEST(Distance, ParallelEdgesThatOverlapHaveAFiniteUnitGradient) {
  const Stencil x{{-1, 0.1, 0}, {1, 0.1, 0}, {-0.5, 0, 0}, {2, 0, 0}};
  const Closest c = closest_edge_edge(x);
  expect_well_formed(c, 2);
  const Vec3 n = combine(c.weight, x).normalized();
  EXPECT_NEAR((n - Vec3(0, 1, 0)).norm(), 0, 1e-14);
}

TEST(Distance, GradientIsTheSlopeForRandomStencilsOfEveryFeature) {
  std::mt19937_64 generator(2);
  std::uniform_real_distribution<Real> u(-1, 1);
  int features[2][3] = {};
  for (int trial = 0; trial < 400; ++trial) {
    Stencil x;
    for (Vec3& p : x) p = Vec3(u(generator), u(generator), u(generator));
    const Closest4 closest = trial % 2 == 0 ? closest_vertex_triangle : closest_edge_edge;
    if (distance2(closest, x) < 1e-2) continue;
    ++features[trial % 2][closest(x).free];
    expect_well_formed(closest(x), trial % 2 == 0 ? 1 : 2);
    expect_gradient(closest, x, "trial " + std::to_string(trial));
  }
  for (const auto& kind : features)
    for (int count : kind) EXPECT_GT(count, 5);
}

TEST(Distance, NoSampledPointsOfTwoRandomPrimitivesAreCloser) {
  std::mt19937_64 generator(4);
  std::uniform_real_distribution<Real> u(-1, 1);
  for (int trial = 0; trial < 300; ++trial) {
    Stencil x;
    for (Vec3& p : x) p = Vec3(u(generator), u(generator), u(generator));
    if (trial % 3 == 0) x[3] = x[2] + (x[1] - x[0]) * u(generator) + 1e-7 * x[3];  // nearly parallel, or a sliver
    const Real vt = std::sqrt(distance2(closest_vertex_triangle, x)), ee = std::sqrt(distance2(closest_edge_edge, x));
    for (int i = 0; i <= 20; ++i)
      for (int j = 0; j <= 20; ++j) {
        const Real s = i / 20.0, t = j / 20.0;
        EXPECT_GE((x[0] + s * (x[1] - x[0]) - x[2] - t * (x[3] - x[2])).norm(), ee - 1e-12);
        EXPECT_TRUE(s + t > 1 || (x[0] - x[1] - s * (x[2] - x[1]) - t * (x[3] - x[1])).norm() >= vt - 1e-12);
      }
  }
}

TEST(Distance, WithoutLengthOrAreaThePrimitivesArePoints) {
  const Vec3 p(0, 0, 0), q(3, 4, 0);
  EXPECT_DOUBLE_EQ(distance2(closest_vertex_triangle, {p, q, q, q}), 25);
  EXPECT_DOUBLE_EQ(distance2(closest_edge_edge, {p, p, q, q}), 25);
  EXPECT_DOUBLE_EQ(distance2(closest_edge_edge, {Vec3(-9, 0, 0), Vec3(9, 0, 0), q, q}), 16);
  EXPECT_DOUBLE_EQ(distance2(closest_vertex_triangle, {q, Vec3(-9, 0, 0), Vec3(9, 0, 0), p}), 16);
}

TEST(Distance, ChordDeviationHasTheListedValues) {  // checks.md part 1: r = 26.86 mm, in mm; smaller is a bug
  const std::pair<Real, Real> rows[] = {{0.1, 0.033568}, {0.5, 0.835012}, {1, 3.288132}, {2, 12.347480}, {3, 24.959999}};
  for (const auto& [angle, mm] : rows) EXPECT_NEAR(chord_deviation(26.86e-3, angle) * 1e3, mm, 5e-7);
  EXPECT_DOUBLE_EQ(chord_deviation(1, 2 * std::numbers::pi), 2);
  EXPECT_DOUBLE_EQ(chord_deviation(1, 100), 2);
}

TEST(Distance, NoPointOfAnArcIsFartherFromTheMovingPointOfItsChord) {
  for (Real angle = 0.1; angle < 12; angle += 0.1)
    for (int k = 0; k <= 100; ++k) {
      const Real t = k / 100.0;
      const Vec3 arm(1, 0, 0), spin(0, 0, angle);
      const Vec3 chord = (1 - t) * arm + t * rotate(spin, arm);
      EXPECT_LE((rotate(t * spin, arm) - chord).norm(), chord_deviation(1, angle) + 1e-12) << "angle " << angle << " t " << t;
    }
}
