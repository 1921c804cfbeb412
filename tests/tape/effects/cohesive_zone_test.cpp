#include "tape/effects/cohesive_zone.inl"

#include <gtest/gtest.h>

#include "tape/contact/surface.hpp"
#include "tests/support/simulation.hpp"
using namespace tape;

namespace {
constexpr Real kDhat = 1.8e-4, kXi = 9e-5, kRest = kXi + kDhat / 2;  // [m]

/// A triangle of a strip whose centroid stands over a triangle of a body in the plane z = 0.
struct Sample {
  AreaCohesion law{.strength = 1e5, .toughness = 10, .peak = 0.1, .shear = 0.5, .reach = 0.5};
  std::vector<Vec3> start{{0, 0, kRest}, {6e-4, 0, kRest}, {0, 6e-4, kRest}, {-1e-3, -1e-3, 0}, {2e-3, -1e-3, 0}, {-1e-3, 2e-3, 0}};
  std::vector<Vec3> x = start;
  std::vector<Adhesion> adhesion{{AdhesionLaw::per_area, {{false, false}, {true, true}}, {}, {}, {}}};
  SamplePair pair{.v = {0, 1, 2, 3, 4, 5}, .w = {1. / 3, 1. / 3, 1. / 3}, .interface = 0, .xi = kXi, .area = 2e-6, .id = {0, 9}};
  CohesiveZone zone{{}, kDhat, 1, 4};
  CohesiveZone::Element element;

  StateView view(const std::vector<Vec3>& at) {
    adhesion[0].area = law;
    StateView s{};
    s.x = {at.data(), 6};
    s.adhesion = {adhesion.data(), 1};
    return s;
  }
  CohesiveZone::Memory stuck() {
    CohesiveZone::Memory m{};
    EXPECT_TRUE(zone.begin(pair, view(start), m));
    return m;
  }
  /// Starts a step at `start` and ends it where the strip has moved by `way` from there.
  StateView step(const CohesiveZone::Memory& m, const Vec3& way) {
    element = zone.recall(m, pair, view(start));
    zone.elements = {&element, 1};
    for (std::size_t k = 0; k < 3; ++k) x[k] = start[k] + way;
    return view(x);
  }
  /// [Pa] by which the strip is drawn back.
  Vec3 traction(const CohesiveZone::Memory& m, const Vec3& way) {
    const VecN<18> g = zone.gradient(step(m, way), 0);
    return (g.segment<3>(0) + g.segment<3>(3) + g.segment<3>(6)) / pair.area;
  }
};
}  // namespace

TEST(CohesiveZone, TractionRisesToTheStrengthAndFallsToNothingAtTheFinalOpening) {  // final 2 R/s = 0.2 mm
  Sample s;
  const CohesiveZone::Memory m = s.stuck();
  EXPECT_NEAR(s.traction(m, {0, 0, 1e-5}).z(), 0.5e5, 1e-6 * 1e5) << "half way to the peak";
  EXPECT_NEAR(s.traction(m, {0, 0, 2e-5}).z(), 1e5, 1e-6 * 1e5) << "the peak";
  EXPECT_NEAR(s.traction(m, {0, 0, 1.1e-4}).z(), 0.5e5, 1e-6 * 1e5) << "half way down";
  EXPECT_NEAR(s.traction(m, {0, 0, 2.1e-4}).z(), 0, 1e-9);
  EXPECT_NEAR(s.traction(m, {0, 0, -5e-5}).norm(), 0, 1e-9) << "pressing is the barrier's";
}
TEST(CohesiveZone, WorkOfSeparationIsTheToughnessInOneStepOrInMany) {
  for (int steps : {1, 7, 100}) {
    Sample s;
    CohesiveZone::Memory m = s.stuck();
    Real sum = 0;
    const Vec3 way(0, 0, 2.5e-4 / steps);
    for (int k = 0; k < steps; ++k) {
      const StateView end = s.step(m, way);
      sum += s.zone.energy(end, 0) - s.zone.energy(s.view(s.start), 0);
      const bool stays = s.zone.renew(end, 0, m);
      s.start = s.x;
      if (!stays) break;
      ASSERT_LT(k + 1, steps) << "it lets go at the end";
    }
    EXPECT_NEAR(sum, 10 * 2e-6, 1e-12 * 10 * 2e-6) << steps << " steps";
  }
}
TEST(CohesiveZone, SlipCountsByItsWeight) {
  Sample s;
  const CohesiveZone::Memory m = s.stuck();
  // delta = sqrt(r) |u|; traction along the slip r u phi'/delta = sqrt(r) phi'
  EXPECT_NEAR(s.traction(m, {0.6 * 2e-5, 0.8 * 2e-5, 0}).norm(), std::sqrt(0.5) * std::sqrt(0.5) * 1e5, 1e-3 * 1e5);
  EXPECT_NEAR(s.traction(m, {6e-4, 0, 0}).norm(), 0, 1e-9) << "sheared off";
  s.law.shear = 0;
  EXPECT_NEAR(s.traction(m, {1e-4, 0, 0}).norm(), 0, 1e-9) << "r = 0: it slides freely";
}
TEST(CohesiveZone, WhatIsTornStaysTorn) {
  Sample s;
  CohesiveZone::Memory m = s.stuck();
  const StateView end = s.step(m, {0, 0, 1.1e-4});
  ASSERT_TRUE(s.zone.renew(end, 0, m));
  EXPECT_NEAR(s.traction(m, {0, 0, 0.55e-4}).z(), 0.25e5, 1e-6 * 1e5) << "back along the secant";
  EXPECT_NEAR(s.traction(m, {0, 0, 1.1e-4}).z(), 0.5e5, 1e-6 * 1e5) << "and on from where it was";
  EXPECT_NEAR(s.zone.energy(s.step(m, {0, 0, 0}), 0), 0, 1e-20);
}
TEST(CohesiveZone, SticksWhereItIsPressedToItsRestAndNotBefore) {
  for (const auto& [above, sticks] : {std::pair{-1e-9, true}, std::pair{1e-9, false}}) {
    Sample s;
    for (std::size_t k = 0; k < 3; ++k) s.start[k].z() += above;
    CohesiveZone::Memory m{};
    EXPECT_EQ(s.zone.begin(s.pair, s.view(s.start), m), sticks) << above;
    s.law.reach = 1;
    EXPECT_TRUE(s.zone.begin(s.pair, s.view(s.start), m));
    s.adhesion[0].law = AdhesionLaw::per_pair;
    EXPECT_FALSE(s.zone.begin(s.pair, s.view(s.start), m));
  }
}
TEST(CohesiveZone, OnlyStickyFacesStick) {
  Sample s;
  s.stuck();  // the triangle's normal points up, its backing is turned away
  std::swap(s.pair.v[1], s.pair.v[2]);
  CohesiveZone::Memory m{};
  EXPECT_FALSE(s.zone.begin(s.pair, s.view(s.start), m));
}
TEST(CohesiveZone, OfStripOnStripTheStickyFaceCarriesAllAndOfEqualFacesEachHalf) {
  Sample s;
  for (auto& of_sample : s.adhesion[0].sticks) of_sample[0] = of_sample[1] = true;
  const Real whole = s.traction(s.stuck(), {0, 0, 1e-5}).z();
  s.pair.id.triangle = 3;  // of the strips' four
  EXPECT_NEAR(s.traction(s.stuck(), {0, 0, 1e-5}).z(), whole, 1e-9 * whole) << "sticky on backing";
  std::swap(s.pair.v[4], s.pair.v[5]);
  EXPECT_NEAR(s.traction(s.stuck(), {0, 0, 1e-5}).z(), whole / 2, 1e-9 * whole) << "sticky on sticky";
  std::swap(s.pair.v[1], s.pair.v[2]);
  CohesiveZone::Memory m{};
  EXPECT_FALSE(s.zone.begin(s.pair, s.view(s.start), m)) << "backing on sticky: the other strip's samples do it";
  std::swap(s.pair.v[4], s.pair.v[5]);
  EXPECT_NEAR(s.traction(s.stuck(), {0, 0, 1e-5}).z(), whole / 2, 1e-9 * whole) << "backing on backing";
}
