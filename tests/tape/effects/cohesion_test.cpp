#include "tape/effects/cohesion.inl"

#include <gtest/gtest.h>

#include "tape/math/rotation.hpp"
using namespace tape;

namespace {
constexpr Real kDhat = 1.8e-4, kXi = 9e-5, kRest = kXi + kDhat / 2;  // [m]

/// A vertex over the middle of a triangle in the plane z = 0, both of strips that face each other with their sticky sides.
struct Stuck {
  PairCohesion law{.cn = 0.675, .ct = 0.675, .beta0 = 1};
  std::vector<Vec3> start{{3e-4, 3e-4, kRest}, {0, 0, 0}, {0, 1e-3, 0}, {1e-3, 0, 0}, {1, 0, kRest}, {0, 1, kRest}}, x = start;
  std::vector<int> first_corner{0, 1, 1, 1, 1};
  std::vector<Index2> corners{{4, 5}};  // of the vertex's other triangle, which faces up
  std::vector<Adhesion> adhesion{{AdhesionLaw::per_pair, {{false, false}, {false, true}}, {}, {}, {}}};
  ContactPair pair{.v = {0, 1, 2, 3},
                   .kind = PairKind::vertex_triangle,
                   .interface = 0,
                   .xi = kXi,
                   .dhat = kDhat,
                   .kappa = 1e4,
                   .weight = 1e-6,
                   .mollifier = 0,
                   .sharing = {},
                   .triangle = 7};
  Real dt = 0.01;
  Cohesion cohesion{{}, kDhat};
  Cohesion::Element element;

  StateView view(const std::vector<Vec3>& at) {
    adhesion[0].pair = law;
    StateView s{};
    s.dt = dt;
    s.x = {at.data(), 6};
    s.x_start = {start.data(), 4};
    s.adhesion = {adhesion.data(), 1};
    s.fans = {{first_corner.data(), 5}, {corners.data(), 1}};
    return s;
  }
  /// Starts a step at `start` and ends it at x.
  StateView step(const Cohesion::Memory& m) {
    element = cohesion.recall(m, pair, view(start));
    cohesion.elements = {&element, 1};
    return view(x);
  }
  Cohesion::Memory engaged(Real beta = 1) const { return {{0, 7}, beta, Vec3::Zero()}; }
};
}  // namespace

TEST(Cohesion, OpeningAndSlipCostWhatThePaperSays) {  // eq. 2; checks.md part 3
  Stuck s;
  s.x[0].z() += kDhat;
  EXPECT_NEAR(s.cohesion.energy(s.step(s.engaged()), 0), 6.075e-5, 1e-13);
  s.x[0] = s.start[0] + Vec3(0, 0, 1e-5);
  EXPECT_NEAR(s.cohesion.gradient(s.step(s.engaged()), 0)[2], 0.675 * 1e-5 / kDhat, 1e-12) << "Cn x/dhat";
  s.x[0] = s.start[0] + kDhat * Vec3(0.6, 0.8, 0);
  EXPECT_NEAR(s.cohesion.energy(s.step(s.engaged()), 0), 1.215e-4, 1e-13);
  const VecN<12> g = s.cohesion.gradient(s.step(s.engaged()), 0);
  EXPECT_NEAR(g.head<2>().norm(), 2 * 0.675, 1e-9) << "2 Ct s/dhat";
  EXPECT_NEAR(g[0] / g[1], 0.75, 1e-9);
  EXPECT_NEAR(s.cohesion.energy(s.step(s.engaged(0.5)), 0), 1.215e-4 / 4, 1e-13) << "beta^2";
}
TEST(Cohesion, APairThatTurnsAsAWholeDoesNotSlip) {
  Stuck s;
  s.start[0] = Vec3(4e-4, -3e-5, kRest);  // beside an edge: the offset leans
  const Pose by{rotation_exp(Vec3(0.3, 0.5, -0.2)), Vec3(1e-3, 0, 0)};
  for (int k = 0; k < 4; ++k) s.x[static_cast<std::size_t>(k)] = apply(by, s.start[static_cast<std::size_t>(k)]);
  const StateView end = s.step(s.engaged());
  s.element.rest = PairState::at(s.pair, end.x).d;
  EXPECT_LT(s.cohesion.gradient(end, 0).norm(), 1e-12 * 0.675);
}
TEST(Cohesion, InTheFixedFrameAPairThatTurnsSlipsByItsDistanceTimesTheAngle) {
  Stuck s;
  s.cohesion.frame = SlipFrame::fixed;
  const Mat3 turn = rotation_exp(Vec3(0, 0.01, 0));
  for (int k = 0; k < 4; ++k) s.x[static_cast<std::size_t>(k)] = turn * s.start[static_cast<std::size_t>(k)];
  const StateView end = s.step(s.engaged());
  EXPECT_NEAR(s.cohesion.slip(end, 0).norm(), kRest * std::sin(0.01), 1e-12);
}
TEST(Cohesion, OpeningAlongALeaningOffsetIsNoSlip) {  // the vertex is beside an edge: the contact normal is not the triangle's
  for (SlipFrame frame : {SlipFrame::turning, SlipFrame::fixed}) {
    Stuck s;
    s.cohesion.frame = frame;
    const Vec3 n(0.6, 0, 0.8), foot(1e-3 / 2, 1e-3 / 2, 0);  // not across the edge from (0, 1, 0) mm to (1, 0, 0) mm in z alone
    const Vec3 across = (n - n.dot(Vec3(1, -1, 0)) / 2 * Vec3(1, -1, 0)).normalized();
    s.start[0] = foot + kRest * across;
    s.x[0] = s.start[0] + 2e-5 * across;
    const StateView end = s.step(s.engaged());
    EXPECT_LT(s.cohesion.slip(end, 0).norm(), 1e-16);
    EXPECT_NEAR(s.cohesion.energy(end, 0), 0.675 / (2 * kDhat) * 4e-10, 1e-15);
  }
}
TEST(Cohesion, ConstantOpeningDebondsAsExplicitEulerSays) {  // checks.md part 3
  for (const auto& [opening, beta] : {std::pair{0.75, 0.50285132}, std::pair{1.0, 0.26362698}}) {
    Stuck s;
    s.law.drop = 2;
    s.start[0].z() = s.x[0].z() = kRest + opening * kDhat;
    Cohesion::Memory m = s.engaged();
    for (int k = 0; k < 1000; ++k) {
      const StateView end = s.step(m);
      ASSERT_TRUE(s.cohesion.renew(end, 0, m));
    }
    EXPECT_NEAR(m.beta, beta, 1e-8) << opening;
  }
}
TEST(Cohesion, DebondingStartsAtHalfABandOfOpening) {  // W = 1, beta = 1: a_n = 1 at x = dhat/2
  for (const auto& [opening, loses] : {std::pair{0.499, false}, std::pair{0.501, true}}) {
    Stuck s;
    s.law.drop = 1;
    s.x[0].z() = kRest + opening * kDhat;
    Cohesion::Memory m = s.engaged();
    const StateView end = s.step(m);
    ASSERT_TRUE(s.cohesion.renew(end, 0, m));
    EXPECT_EQ(m.beta < 1, loses) << opening;
  }
}
TEST(Cohesion, WorkOfPullingAPairOffDependsOnWhereItIsDropped) {  // trap T4: 6 mm/s, work/(Cn dhat)
  for (const auto& [drop, work] : {std::pair{1.0, 0.499}, std::pair{5.0, 8.90}}) {
    Stuck s;
    s.law.drop = drop;
    Cohesion::Memory m = s.engaged();
    Real sum = 0;
    for (int k = 0;; ++k) {
      s.start = s.x;
      s.x[0].z() += 6e-3 * s.dt;
      const StateView end = s.step(m);
      const Real before = s.cohesion.energy(s.view(s.start), 0);
      sum += s.cohesion.energy(end, 0) - before;  // with beta held, as in the step
      if (!s.cohesion.renew(end, 0, m)) break;
      ASSERT_LT(k, 100);
    }
    EXPECT_NEAR(sum / (0.675 * kDhat), work, 0.005 * work) << drop;
  }
}
TEST(Cohesion, CompressionEngagesInOneStepAtTheReferencePressure) {  // p0 = 0: beta 0 -> 1 in 10 ms where p >= p_b
  Stuck s;
  s.law.beta0 = 0;
  Cohesion::Memory m{};
  s.x[0].z() = kXi + 0.5 * kDhat;
  EXPECT_TRUE(s.cohesion.begin(s.pair, s.view(s.x), m));
  EXPECT_NEAR(m.beta, 1, 1e-12);
  EXPECT_EQ(m.vertex, 0);
  EXPECT_EQ(m.triangle, 7);
  s.x[0].z() = kXi + 0.98 * kDhat;
  EXPECT_TRUE(s.cohesion.begin(s.pair, s.view(s.x), m));
  EXPECT_GT(m.beta, 0);
  EXPECT_LT(m.beta, 0.05);
  s.x[0].z() = kXi + 1.001 * kDhat;
  EXPECT_FALSE(s.cohesion.begin(s.pair, s.view(s.x), m)) << "out of the band";
}
TEST(Cohesion, OnlyStickyFacesAdhere) {
  Stuck s;
  Cohesion::Memory m{};
  EXPECT_TRUE(s.cohesion.begin(s.pair, s.view(s.x), m)) << "the triangle's normal points down, the vertex's up: sticky faces meet";
  s.corners[0] = Index2(5, 4);
  EXPECT_FALSE(s.cohesion.begin(s.pair, s.view(s.x), m)) << "the vertex turns its backing";
  s.corners[0] = Index2(4, 5);
  std::swap(s.pair.v[1], s.pair.v[2]);
  EXPECT_FALSE(s.cohesion.begin(s.pair, s.view(s.x), m)) << "the triangle turns its backing";
  s.adhesion[0].sticks[1][0] = true;
  EXPECT_TRUE(s.cohesion.begin(s.pair, s.view(s.x), m)) << "sticky vertex on a backing";
  s.pair.kind = PairKind::edge_edge;
  EXPECT_FALSE(s.cohesion.begin(s.pair, s.view(s.x), m)) << "edges never stick";
}
/// As of pairs that settled by the other rule, slept in a cluster and wake.
TEST(Cohesion, SlipThatIsRememberedCountsOnlyWhereItAddsUp) {
  for (SlipFrom from : {SlipFrom::step, SlipFrom::bonding}) {
    Stuck s;
    s.law.slip = SlipFrom::bonding;
    Cohesion::Memory m = s.engaged();
    s.x[0] += Vec3(3e-6, 4e-6, 0);
    ASSERT_TRUE(s.cohesion.renew(s.step(m), 0, m));
    ASSERT_GT(Eigen::Map<const Vec3>(m.slip.data()).norm(), 0);
    s.law.slip = from;
    s.start = s.x;
    EXPECT_NEAR(s.cohesion.slip(s.step(m), 0).norm(), from == SlipFrom::step ? 0 : 5e-6, 1e-12);
  }
}
TEST(Cohesion, SlipSinceBondingAddsUpAndSlipOfTheStepDoesNot) {
  for (SlipFrom from : {SlipFrom::step, SlipFrom::bonding}) {
    Stuck s;
    s.law.slip = from;
    Cohesion::Memory m = s.engaged();
    Real force = 0;
    for (int k = 1; k <= 4; ++k) {
      s.start = s.x;
      s.x[0] += Vec3(3e-6, 4e-6, 0);
      const StateView end = s.step(m);
      force = s.cohesion.gradient(end, 0).head<2>().norm();
      EXPECT_NEAR(force, 2 * 0.675 * 5e-6 / kDhat * (from == SlipFrom::step ? 1 : k), 1e-9) << k;
      ASSERT_TRUE(s.cohesion.renew(end, 0, m));
    }
  }
}
