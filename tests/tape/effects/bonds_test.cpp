#include "tape/effects/bonds.inl"

#include <gtest/gtest.h>

#include "tape/math/rotation.hpp"
#include "tests/support/derivatives.hpp"
using namespace tape;

namespace {
constexpr Real kDhat = 1.8e-4, kXi = 9e-5, kRest = kXi + 0.9 * kDhat;  // [m]
constexpr Real kArea = 5.01388889e-6;                                  // [m^2] checks.md part 3
const Real kSide = std::sqrt(2 * kArea);

/// A vertex bonded over the middle of a triangle in the plane z = 0.
struct Bonded {
  BondLaw law;
  std::vector<Vec3> start{{kSide / 3, kSide / 3, kRest}, {0, 0, 0}, {0, kSide, 0}, {kSide, 0, 0}, {1, 0, kRest}, {0, 1, kRest}}, x = start;
  std::vector<int> first_corner{0, 1, 1, 1, 1};
  std::vector<Index2> corners{{4, 5}};  // of the vertex's other triangle, which faces up
  std::vector<Adhesion> adhesion{{AdhesionLaw::bond, {{false, false}, {false, true}}, {}, {}, {}}};
  ContactPair pair{.v = {0, 1, 2, 3},
                   .kind = PairKind::vertex_triangle,
                   .interface = 0,
                   .xi = kXi,
                   .dhat = kDhat,
                   .kappa = 1e4,
                   .weight = kArea,
                   .mollifier = 0,
                   .sharing = {},
                   .triangle = 7};
  Bonds bonds{{}, kDhat};
  Bonds::Memory memory{};
  Bonds::Element element{};

  StateView view(const std::vector<Vec3>& at) {
    adhesion[0].bond = law;
    StateView s{};
    s.dt = 0.01;
    s.x = {at.data(), 6};
    s.adhesion = {adhesion.data(), 1};
    s.fans = {{first_corner.data(), 5}, {corners.data(), 1}};
    return s;
  }
  bool make() {
    if (!bonds.begin(pair, view(start), memory)) return false;
    element = bonds.recall(memory, pair, view(start));
    bonds.elements = {&element, 1};
    return true;
  }
  Vec3 force() { return -bonds.gradient(view(x), 0).head<3>(); }
};
}  // namespace

TEST(Bonds, NormalStretchPullsByTheClosedForm) {  // f = 4/3 kappa A lambda (lambda^2 - 1); checks.md part 3
  Bonded b;
  ASSERT_TRUE(b.make());
  for (Real lambda : {1.0354850027, 1.2, 0.9}) {
    b.x[0].z() = lambda * kRest;
    EXPECT_NEAR(b.force().z(), -4.0 / 3 * 1e6 * kArea * lambda * (lambda * lambda - 1), 1e-9) << lambda;
  }
  b.x[0].z() = 1.0354850027 * kRest;
  EXPECT_NEAR(b.force().norm(), 0.5, 1e-8);
}
TEST(Bonds, ShearReachesTheBreakForceButNeverReleases) {  // 6.685185 g (1 + g^2) N
  Bonded b;
  ASSERT_TRUE(b.make());
  for (Real g : {0.0743807329, 0.5}) {
    b.x[0] = b.start[0] + Vec3(g * kRest, 0, 0);
    EXPECT_NEAR(b.force().x(), -6.685185 * g * (1 + g * g), 1e-5 * g);
    EXPECT_EQ(b.bonds.load(b.view(b.x), 0), 0) << "d = d_ref";
  }
}
TEST(Bonds, ARigidMotionCostsNothing) {
  Bonded b;
  ASSERT_TRUE(b.make());
  const Pose by{rotation_exp(Vec3(0.3, 2.5, -0.2)), Vec3(0.3, 0, 0.1)};
  for (Vec3& p : b.x) p = apply(by, p);
  EXPECT_LE(b.bonds.energy(b.view(b.x), 0), 1e-20);
}
TEST(Bonds, ReleaseIsInTensionAtTheThresholdAndIsRememberedForAWhile) {
  Bonded b;
  b.law.cooldown = 2;
  ASSERT_TRUE(b.make());
  b.x[0].z() = 1.0354 * kRest;
  EXPECT_LT(b.bonds.load(b.view(b.x), 0), 1) << "just below 0.5 N";
  EXPECT_LT(b.bonds.accuracy_to_judge(b.view(b.x), 0), 1e-6) << "0.5 N in 9 um";
  b.x[0].z() = 0.9 * kRest;
  EXPECT_GT(b.force().norm(), 0.5);
  EXPECT_EQ(b.bonds.load(b.view(b.x), 0), 0) << "compression never releases";
  b.x[0].z() = 1.0356 * kRest;
  EXPECT_GT(b.bonds.load(b.view(b.x), 0), 1);
  EXPECT_TRUE(b.memory.replaces_contact());
  b.bonds.let_go(b.view(b.x), 0, b.memory);
  EXPECT_FALSE(b.memory.replaces_contact());
  b.element = b.bonds.recall(b.memory, b.pair, b.view(b.x));
  EXPECT_EQ(b.bonds.energy(b.view(b.x), 0), 0);
  EXPECT_EQ(b.bonds.load(b.view(b.x), 0), 0) << "it bears nothing any more";
  EXPECT_TRUE(b.bonds.renew(b.view(b.x), 0, b.memory)) << "the end of its step";
  EXPECT_EQ(b.memory.cooldown, 2);
  EXPECT_TRUE(b.bonds.renew(b.view(b.x), 0, b.memory));
  EXPECT_FALSE(b.bonds.renew(b.view(b.x), 0, b.memory)) << "forgotten: it may bond again";
}
TEST(Bonds, FormOverTheFaceWithinReachAndAboveTheFloor) {
  const auto bonds_at = [](const Vec3& vertex) {
    Bonded b;
    b.start[0] = vertex;
    return b.make();
  };
  const Real c = kSide / 3;
  EXPECT_TRUE(bonds_at({c, c, kXi + 0.99 * kDhat}));
  EXPECT_FALSE(bonds_at({c, c, kXi + 1.01 * kDhat})) << "out of reach";
  EXPECT_TRUE(bonds_at({c, c, kXi + 0.51 * kDhat}));
  EXPECT_FALSE(bonds_at({c, c, kXi + 0.49 * kDhat})) << "below the floor";
  EXPECT_FALSE(bonds_at({c, -1e-5, kXi + 0.6 * kDhat})) << "beside the face";
  EXPECT_FALSE(bonds_at({c, c, -(kXi + 0.6 * kDhat)})) << "on the backing";
}
TEST(Bonds, TheFlipGuardTakesOverWhereTheBondGivesUp) {
  // Alone the bond pushes back with at most 2.573 N (T5); with the guard the push grows without bound down to contact.
  Bonded b;
  ASSERT_TRUE(b.make());
  Real most_alone = 0, before = 0;
  for (Real lambda = 0.99; lambda > 0.001; lambda -= 0.001) {
    most_alone = std::max(most_alone, 4.0 / 3 * 1e6 * kArea * lambda * (1 - lambda * lambda));
    b.x[0].z() = lambda * kRest;
    const Real push = b.force().z();
    if (lambda > 0.5) {
      EXPECT_NEAR(push, 4.0 / 3 * 1e6 * kArea * lambda * (1 - lambda * lambda), 1e-9);
    }
    before = push;
  }
  EXPECT_NEAR(most_alone, 2.573, 1e-3);
  EXPECT_GT(before, 5);
}
