#include "tape/effects/barrier.inl"

#include <gtest/gtest.h>

#include <numbers>
#include <random>

#include "tests/support/derivatives.hpp"
#include "tests/support/effect_world.hpp"
using namespace tape;

namespace {
constexpr Real kDhat = 1.8e-4;
constexpr BarrierLaw kLaw{1, kDhat};
constexpr Real kUnit = 4 / kDhat;  // weight that makes the energy B itself

/// One pair with its vertices.
struct Pair {
  std::vector<Vec3> x;
  ContactPair pair;
  Barrier barrier;
  Pair(PairKind kind, std::vector<Vec3> at, Real mollifier = 0)
      : x(std::move(at)), pair{{0, 1, 2, 3}, kind, 0, 9e-5, kDhat, 1, kUnit, mollifier, {}}, barrier{{&pair, 1}} {}
  Pair(const Pair&) = delete;
  Pair& operator=(const Pair&) = delete;
  StateView view() const {
    StateView s{};
    s.x = {x.data(), 4};
    return s;
  }
};
/// Edges of 2 mm that cross in the middle at the given angle, one above the other.
std::vector<Vec3> crossing(Real angle, Real height) {
  const Vec3 along = 1e-3 * Vec3(std::cos(angle), std::sin(angle), 0), up(0, 0, height);
  return {up - Vec3(1e-3, 0, 0), up + Vec3(1e-3, 0, 0), -along, along};
}
constexpr Real kFade = 1e-3 * 4e-6 * 4e-6;  // of two edges of 2 mm
}  // namespace

TEST(BarrierLaw, HasThePublishedNumbers) {  // B and dB/dd for kappa 1: r = 1/4 gives (3/4 ln 4)^2 without offset
  const Jet plain = kLaw.at(kDhat / 2, 0, kUnit), thick = kLaw.at(9e-5 + kDhat / 2, 9e-5, kUnit);
  EXPECT_NEAR(plain.value, 1.0810192813, 1e-10);
  EXPECT_NEAR(plain.slope, -5.0672459492e4, 1e-6);
  EXPECT_NEAR(thick.value, 0.37579141545, 1e-11);
  EXPECT_NEAR(thick.slope, -1.8032926703e4, 1e-6);
}
TEST(BarrierLaw, SlopeAndCurvatureAreTheDerivatives) {
  for (Real xi : {0.0, 9e-5}) {
    for (Real gap : {1e-3, 0.1, 0.5, 0.9, 0.999}) {
      const Real d = xi + gap * kDhat, step = 1e-3 * std::min(gap, 1 - gap) * kDhat;
      const auto value = [&](const Eigen::VectorXd& q) { return kLaw.at(q[0], xi, kUnit).value; };
      const auto slope = [&](const Eigen::VectorXd& q) { return kLaw.at(q[0], xi, kUnit).slope; };
      const Eigen::VectorXd at = Eigen::VectorXd::Constant(1, d);
      const Jet b = kLaw.at(d, xi, kUnit);
      EXPECT_NEAR(test::slope(value, at, step)[0], b.slope, 1e-7 * std::abs(b.slope)) << xi << " " << gap;
      EXPECT_NEAR(test::slope(slope, at, step)[0], b.curvature, 1e-7 * std::abs(b.curvature)) << xi << " " << gap;
    }
  }
}
TEST(BarrierLaw, IsConvexAllTheWay) {
  for (Real xi : {0.0, 9e-5, 1e-2})
    for (int k = 1; k < 1000; ++k) EXPECT_GT(kLaw.at(xi + k * kDhat / 1000, xi, kUnit).curvature, 0) << xi << " " << k;
}
TEST(BarrierLaw, IsZeroAndSmoothAtItsReachAndInfiniteAtContact) {
  const Real end = 9e-5 + kDhat;
  EXPECT_EQ(kLaw.at(end, 9e-5, kUnit).value, 0);
  EXPECT_LT(std::abs(kLaw.at(end * (1 - 1e-9), 9e-5, kUnit).slope) * kDhat, 1e-20);
  EXPECT_TRUE(std::isinf(kLaw.at(9e-5, 9e-5, kUnit).value));
  EXPECT_TRUE(std::isinf(kLaw.at(8e-5, 9e-5, kUnit).value));
}
TEST(BarrierLaw, KeepsItsDigitsNextToContact) {
  // (d - xi)(d + xi) / (dhat (dhat + 2 xi)) with d = xi + g: r = g (2 xi + g) / (dhat (dhat + 2 xi))
  const Real xi = 9e-5, gap = std::ldexp(1.0, -60), d = xi + gap, g = d - xi;
  const Real r = g * (2 * xi + g) / (kDhat * (kDhat + 2 * xi)), expected = std::pow((r - 1) * std::log(r), 2);
  EXPECT_NEAR(kLaw.at(d, xi, kUnit).value, expected, 1e-12 * expected);
}

TEST(Barrier, BetweenTwoPointsTheProjectedHessianIsThePositivePartOfTheExactOne) {
  const Vec3 n = Vec3(1, 2, -2) / 3, far(-3e-3, 1e-3, 0), wide(-1e-3, -3e-3, 1e-3);
  const Vec3 corner(0.01, 0.02, 0.03);
  const Vec3 a = corner + far - n * far.dot(n), b = corner + wide - n * wide.dot(n);
  for (Real gap : {0.05, 0.5, 0.95}) {
    // the vertex stands above the corner, away from the triangle: outside of both edges' slabs
    const Vec3 out = -(far - n * far.dot(n) + wide - n * wide.dot(n)).normalized();
    const Pair p(PairKind::vertex_triangle, {corner + (9e-5 + gap * kDhat) * (0.6 * n + 0.8 * out), corner, a, b});
    ASSERT_EQ(closest_vertex_triangle({p.x[0], p.x[1], p.x[2], p.x[3]}).free, 0);
    const MatN<12, 12> exact = p.barrier.hessian(p.view(), 0, HessianMode::exact);
    const MatN<12, 12> projected = p.barrier.hessian(p.view(), 0, HessianMode::projected);
    EXPECT_LT((projected - test::psd_part(exact)).norm(), 1e-12 * projected.norm()) << gap;
  }
}
TEST(Barrier, KeepsThePositivePartOfTheCurvatureOfDistance) {
  const Vec3 corners[] = {{0, 0, 0}, {1e-3, 0, 1e-4}, {2e-4, 1.3e-3, -1e-4}};
  const Vec3 n = (corners[1] - corners[0]).cross(corners[2] - corners[0]).normalized();
  const auto above = [&](Real a, Real b, Real height) { return Vec3(a * corners[1] + b * corners[2] + height * n); };
  for (Real gap : {1e-6, 1e-3, 0.05}) {
    const Real d = 9e-5 + gap * kDhat;
    const Vec3 side = (corners[1] - corners[0]).cross(n).normalized();
    const Pair pairs[] = {
        {PairKind::vertex_triangle, {above(0.3, 0.2, d), corners[0], corners[1], corners[2]}},
        {PairKind::vertex_triangle, {above(0.4, 0, 0) + d * (0.8 * side + 0.6 * n), corners[0], corners[1], corners[2]}},
        {PairKind::edge_edge, crossing(1.2, d)},
        {PairKind::edge_edge, crossing(0.7, d)},
        {PairKind::edge_edge, crossing(0.02, d), kFade},
    };
    const int free[] = {2, 1, 2, 2, 2};
    for (int k = 0; k < 5; ++k) {
      const Pair& p = pairs[k];
      const PairState at = PairState::at(p.pair, p.view().x);
      ASSERT_EQ(at.closest.free, free[k]);
      MatN<12, 12> sum = MatN<12, 12>::Zero();
      at.for_each_saddle([&](Real c, const VecN<12>& v) { sum += c * v * v.transpose(); });
      EXPECT_LT((sum - test::psd_part(at.hessian(-1, 0))).norm(), 1e-9 * sum.norm()) << k << " " << gap;
      if (at.fade.slope != 0) continue;  // the second derivative of the cross product is left out
      const MatN<12, 12> exact = p.barrier.hessian(p.view(), 0, HessianMode::exact);
      const MatN<12, 12> projected = p.barrier.hessian(p.view(), 0, HessianMode::projected);
      EXPECT_GE(test::smallest_eigenvalue(projected - exact), -1e-9 * exact.norm()) << k << " " << gap;
    }
  }
}
TEST(Barrier, PushesApartAlongTheNormalWithItsNormalForce) {
  const Real d = 9e-5 + kDhat / 2;
  const Pair p(PairKind::vertex_triangle, {{2e-4, 2e-4, d}, {0, 0, 0}, {1e-3, 0, 0}, {0, 1e-3, 0}});
  const VecN<12> g = p.barrier.gradient(p.view(), 0);
  EXPECT_NEAR(p.barrier.normal_force(PairState::at(p.pair, p.view().x), p.pair), 1.8032926703e4, 1e-5);
  EXPECT_NEAR(-g[2], 1.8032926703e4, 1e-5);       // the vertex goes up
  EXPECT_NEAR(g[5], 0.6 * 1.8032926703e4, 1e-5);  // corners down by their barycentric coordinates
  EXPECT_NEAR(g.head<2>().norm(), 0, 1e-9);
}
namespace {
/// Six triangles around the origin, roofed by `slope` along the line x = 0 (positive: a valley), with a vertex at `x` above.
struct Fan {
  std::vector<Vec3> x;
  std::vector<ContactPair> pairs;
  Fan(const Vec3& at, Real slope) : x{at, Vec3::Zero()} {
    for (int k = 0; k < 6; ++k) {
      const Real angle = k * std::numbers::pi / 3 + std::numbers::pi / 6, c = 2e-3 * std::cos(angle);
      x.emplace_back(c, 2e-3 * std::sin(angle), slope * std::fabs(c));
    }
    for (int k = 0; k < 6; ++k)
      pairs.push_back({.v = {0, 1, 2 + k, 2 + (k + 1) % 6},
                       .kind = PairKind::vertex_triangle,
                       .interface = 0,
                       .xi = 9e-5,
                       .dhat = kDhat,
                       .kappa = 1,
                       .weight = kUnit,
                       .mollifier = 0,
                       .sharing = {{2, 1, 2}, {6, 0, 0}}});
  }
  template <class F>
  auto sum(const F& f) const {
    Barrier barrier{{pairs.data(), 6}};
    StateView s{};
    s.x = {x.data(), static_cast<int>(x.size())};
    auto total = f(barrier, s, 0);
    for (int i = 1; i < 6; ++i) total += f(barrier, s, i);
    return total;
  }
  Real energy() const {
    return sum([](const Barrier& b, const StateView& s, int i) { return b.energy(s, i); });
  }
  Vec3 force() const {
    return sum([](const Barrier& b, const StateView& s, int i) { return Vec3(-b.gradient(s, i).head<3>()); });
  }
};
const Real kHeight = 9e-5 + kDhat / 2, kOnce = 0.37579141545, kPush = 1.8032926703e4;  // checks.md part 2
}  // namespace
TEST(Barrier, OverAFlatSheetAVertexMeetsTheSameBarrierEverywhere) {
  for (const Vec3& at :
       {Vec3(5e-4, 2e-4, 0), Vec3(4e-4, 0, 0), Vec3(0, 0, 0), Vec3(1e-6, 2e-6, 0), Vec3(3e-5, 1e-4, 0), Vec3(0, 8e-4, 0)}) {
    const Fan fan(at + Vec3(0, 0, kHeight), 0);
    EXPECT_NEAR(fan.energy(), kOnce, 1e-10) << at.transpose();
    EXPECT_LT((fan.force() - Vec3(0, 0, kPush)).norm(), 1e-9 * kPush) << at.transpose();
  }
}
TEST(Barrier, ARidgeCountsOnceAndAValleyPushesFromBothItsWalls) {
  const auto law = [](Real d) { return kLaw.at(d, 9e-5, kUnit).value; };
  for (const Real y : {0.0, 5e-4}) EXPECT_NEAR(Fan(Vec3(0, y, kHeight), -1).energy(), law(kHeight), 1e-10) << "above the ridge, y = " << y;
  // In the middle of a valley of 90 degrees, at distance d from both walls, the line between them is sqrt(2) d away.
  for (const Real y : {0.0, 5e-4})
    EXPECT_NEAR(Fan(Vec3(0, y, std::numbers::sqrt2 * 1.6e-4), 1).energy(), 2 * law(1.6e-4) - law(std::numbers::sqrt2 * 1.6e-4), 1e-10) << y;
}
TEST(Barrier, OverAFoldedSheetTheEnergyIsContinuousAndItsForceTheSlope) {
  for (const Real slope : {-0.7, -0.1, 0.1, 0.7})
    for (Real s = -3e-4; s < 3e-4; s += 7e-6) {
      const Vec3 at(s, 0.3 * s + 2e-5, kHeight + 1e-5 + slope * std::fabs(s));
      const auto energy = [&](const Eigen::VectorXd& q) { return Fan(q, slope).energy(); };
      EXPECT_LT((Fan(at, slope).force() + test::slope(energy, at, 1e-9)).norm(), 1e-4 * kPush) << slope << " " << s;
    }
}
TEST(Barrier, ParallelEdgesFadeToNothing) {
  const Real d = 9e-5 + kDhat / 2;
  const Pair parallel(PairKind::edge_edge, crossing(0, d), kFade);
  EXPECT_FALSE(parallel.barrier.active(parallel.view(), 0));
  EXPECT_EQ(parallel.barrier.energy(parallel.view(), 0), 0);
  Real last = 0.37579141545;                           // unfaded
  for (Real angle : {0.04, 0.02, 0.01, 1e-3, 1e-5}) {  // sin^2 = 1e-3 at 0.0316
    const Pair p(PairKind::edge_edge, crossing(angle, d), kFade);
    const Real energy = p.barrier.energy(p.view(), 0);
    if (angle > 0.035) {
      EXPECT_NEAR(energy, last, 1e-10);
    } else {
      EXPECT_LT(energy, last);
    }
    last = energy;
  }
  EXPECT_LT(last, 1e-6);
}
TEST(Barrier, OutOfReachAPairIsNotActive) {
  const Pair in(PairKind::edge_edge, crossing(1, 9e-5 + 0.999 * kDhat), kFade),
      out(PairKind::edge_edge, crossing(1, 9e-5 + 1.001 * kDhat), kFade);
  EXPECT_TRUE(in.barrier.active(in.view(), 0));
  EXPECT_FALSE(out.barrier.active(out.view(), 0));
}
TEST(Barrier, WhatIsFarApartAlongTheNormalIsFarApart) {
  std::mt19937_64 generator(3);
  std::uniform_real_distribution<Real> place(-1e-3, 1e-3);
  for (PairKind kind : {PairKind::vertex_triangle, PairKind::edge_edge}) {
    int far = 0;
    for (int k = 0; k < 2000; ++k) {
      Pair p(kind, {});
      for (int i = 0; i < 4; ++i) p.x.emplace_back(place(generator), place(generator), place(generator));
      if (!far_apart(p.pair, p.view().x, 2.7e-4)) continue;
      ++far;
      EXPECT_GT(PairState::at(p.pair, p.view().x).d, 2.7e-4 * (1 - 1e-12));
    }
    EXPECT_GT(far, 500);
    const Pair flat(kind, std::vector<Vec3>(4, Vec3::Zero()));
    EXPECT_FALSE(far_apart(flat.pair, flat.view().x, 2.7e-4)) << "no normal: nothing is said";
  }
}
TEST(Barrier, IsNeededByAStripOrByTwoBodiesOfWhichOneMoves) {
  Scene scene;
  EXPECT_EQ(Barrier::needed(scene, {}), "");
  scene.bodies.resize(2);
  EXPECT_EQ(Barrier::needed(scene, {}), "");
  scene.bodies[1].motion = Motion::dynamic;
  EXPECT_EQ(Barrier::needed(scene, {}), "bodies");
  scene.bodies.erase(scene.bodies.begin());
  EXPECT_EQ(Barrier::needed(scene, {}), "");
  scene.strips.resize(1);
  EXPECT_EQ(Barrier::needed(scene, {}), "strip");
}
