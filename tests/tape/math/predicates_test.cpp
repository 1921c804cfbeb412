#include "tape/math/predicates.hpp"

#include <gmpxx.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <vector>
using namespace tape;

namespace {
using Rational = std::array<mpq_class, 3>;
Rational rational(const Vec3& p) { return {mpq_class(p.x()), mpq_class(p.y()), mpq_class(p.z())}; }
Rational operator-(const Rational& a, const Rational& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }

/// By another way than the predicate: clips the parameter interval [0, 1] of the segment. In the plane's coordinates a point is
/// a + u (b - a) + v (c - a) + w normal; the segment meets the triangle where w = 0, u >= 0, v >= 0, u + v <= 1. Exact.
/// The triangle has an area.
bool meets_by_clipping(const Vec3& p, const Vec3& q, const Vec3& a, const Vec3& b, const Vec3& c) {
  const Rational origin = rational(a), e = rational(b) - origin, f = rational(c) - origin;
  const Rational n{e[1] * f[2] - e[2] * f[1], e[2] * f[0] - e[0] * f[2], e[0] * f[1] - e[1] * f[0]};
  const mpq_class n2 = n[0] * n[0] + n[1] * n[1] + n[2] * n[2];
  const auto dot_cross = [&](const Rational& x, const Rational& y) {  // n . (x cross y)
    return mpq_class(n[0] * (x[1] * y[2] - x[2] * y[1]) + n[1] * (x[2] * y[0] - x[0] * y[2]) + n[2] * (x[0] * y[1] - x[1] * y[0]));
  };
  const auto conditions = [&](const Vec3& x) {  // all >= 0 in the triangle
    const Rational r = rational(x) - origin;
    const mpq_class u = dot_cross(r, f) / n2, v = dot_cross(e, r) / n2, w = (n[0] * r[0] + n[1] * r[1] + n[2] * r[2]) / n2;
    return std::array<mpq_class, 5>{u, v, 1 - u - v, w, -w};
  };
  const auto at_p = conditions(p), at_q = conditions(q);
  mpq_class low = 0, high = 1;
  for (std::size_t k = 0; k < 5; ++k) {
    const mpq_class slope = at_q[k] - at_p[k];
    if (slope == 0 && at_p[k] < 0) return false;
    if (slope == 0) continue;
    const mpq_class zero = -at_p[k] / slope;
    if (slope > 0 && zero > low) low = zero;
    if (slope < 0 && zero < high) high = zero;
  }
  return low <= high;
}
bool has_area(const Vec3& a, const Vec3& b, const Vec3& c) {
  for (int axis = 0; axis < 3; ++axis)
    if (projected_orientation(a, b, c, axis) != 0) return true;
  return false;
}
}  // namespace

TEST(Predicates, OrientationHasTheSignOfTheVolume) {
  const Vec3 a(0, 0, 0), b(1, 0, 0), c(0, 1, 0);
  EXPECT_EQ(orientation(a, b, c, {0, 0, -1}), 1);
  EXPECT_EQ(orientation(a, b, c, {0, 0, 1}), -1);
  EXPECT_EQ(orientation(a, b, c, {5, -7, 0}), 0);
  EXPECT_EQ(orientation(a, b, c, {0.3, 0.3, 1e-300}), -1) << "products underflow here";
  EXPECT_EQ(projected_orientation(a, b, c, 2), 1);
  EXPECT_EQ(projected_orientation(a, b, c, 0), 0);
}

TEST(Predicates, OrientationSeesTheLastBitFarFromTheOrigin) {
  // The plane x + y + z = 3 through far points; one last bit up or down decides, where the products have lost it.
  const Vec3 a(1e8, -1e8, 3), b(-1e8, 3, 1e8), c(3, 1e8, -1e8);
  const Vec3 on(1, 1, 1);
  EXPECT_EQ(orientation(a, b, c, on), 0);
  const Vec3 above(1, 1, std::nextafter(1.0, 2.0)), below(1, 1, std::nextafter(1.0, 0.0));
  EXPECT_NE(orientation(a, b, c, above), 0);
  EXPECT_EQ(orientation(a, b, c, above), -orientation(a, b, c, below));
}

TEST(Predicates, SegmentsMeetTrianglesAsExactClippingSays) {
  std::mt19937_64 generator(1);
  for (const int grid : {2, 3, 5, 1'000'000}) {  // coarse grids are full of touching, parallel and coplanar cases
    std::uniform_int_distribution<int> u(0, grid);
    const auto point = [&] { return Vec3(0.1 * u(generator), 0.1 * u(generator), 0.1 * u(generator)); };
    int met = 0, tried = 0;
    while (tried < 4000) {
      const Vec3 p = point(), q = point(), a = point(), b = point(), c = point();
      if (!has_area(a, b, c)) continue;
      ++tried;
      const bool expected = meets_by_clipping(p, q, a, b, c);
      met += expected;
      ASSERT_EQ(segment_meets_triangle(p, q, a, b, c), expected) << "grid " << grid;
      ASSERT_EQ(segment_meets_triangle(q, p, b, c, a), expected);
      ASSERT_EQ(segment_meets_triangle(p, q, a, c, b), expected);
    }
    EXPECT_GT(met, 50);
    EXPECT_LT(met, 3950);
  }
}

TEST(Predicates, TouchingCountsAndABitApartDoesNot) {
  const Vec3 a(0, 0, 0), b(1, 0, 0), c(0, 1, 0);
  const Real bit = 1e-300;
  EXPECT_TRUE(segment_meets_triangle({0.2, 0.2, 0}, {0.2, 0.2, 1}, a, b, c)) << "end on the face";
  EXPECT_FALSE(segment_meets_triangle({0.2, 0.2, bit}, {0.2, 0.2, 1}, a, b, c));
  EXPECT_TRUE(segment_meets_triangle({0.5, 0.5, -1}, {0.5, 0.5, 1}, a, b, c)) << "through the rim";
  EXPECT_FALSE(segment_meets_triangle({0.5, std::nextafter(0.5, 1), -1}, {0.5, std::nextafter(0.5, 1), 1}, a, b, c));
  EXPECT_TRUE(segment_meets_triangle({0, 0, 0}, {-1, -1, -1}, a, b, c)) << "a corner";
  EXPECT_TRUE(segment_meets_triangle({-1, 0.25, 0}, {2, 0.25, 0}, a, b, c)) << "across, in the plane";
  EXPECT_TRUE(segment_meets_triangle({0.1, 0.1, 0}, {0.2, 0.2, 0}, a, b, c)) << "inside, in the plane";
  EXPECT_TRUE(segment_meets_triangle({0.25, 0, 0}, {3, 0, 0}, a, b, c)) << "along an edge";
  EXPECT_TRUE(segment_meets_triangle({1, 0, 0}, {3, 0, 0}, a, b, c)) << "end to end";
  EXPECT_FALSE(segment_meets_triangle({std::nextafter(1, 2), 0, 0}, {3, 0, 0}, a, b, c));
}

TEST(Predicates, ThingsWithoutLengthOrAreaAreThePointsThatTheyAre) {
  const Vec3 a(0, 0, 0), b(1, 1, 1), middle(0.5, 0.5, 0.5), off(0.5, 0.5, 0.6);
  EXPECT_TRUE(segment_meets_triangle(middle, middle, a, b, b));
  EXPECT_FALSE(segment_meets_triangle(off, off, a, b, b));
  EXPECT_TRUE(segment_meets_triangle({0, 1, 0.5}, {1, 0, 0.5}, a, middle, b));
  EXPECT_FALSE(segment_meets_triangle({0, 1, 0.6}, {1, 0, 0.6}, a, middle, b));
  EXPECT_TRUE(segment_meets_triangle(a, b, middle, middle, middle));
  EXPECT_FALSE(segment_meets_triangle(a, b, off, off, off));
  EXPECT_TRUE(segment_meets_triangle({0.2, 0.2, 0}, {0.2, 0.2, 0}, a, {1, 0, 0}, {0, 1, 0})) << "a point on a face";
}
