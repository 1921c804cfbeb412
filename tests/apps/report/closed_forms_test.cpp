#include "apps/report/closed_forms.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tape/core/error.hpp"

using namespace tape;
using namespace tape::report;

TEST(ClosedForms, TheHeavyElasticaAgreesWithAnIntegratorOfHigherOrder) {
  struct Row {
    Real gamma, drop, reach;
  };
  // Dormand-Prince 8(5,3), relative tolerance 1e-12
  for (const Row& row : {Row{1, .12347140, .99124640}, Row{10, .70019972, .65635376}, Row{100, .93752394, .15922338}}) {
    const ElasticaTip tip = heavy_elastica(row.gamma);
    EXPECT_NEAR(tip.drop, row.drop, 2e-8) << "at gamma = " << row.gamma;
    EXPECT_NEAR(tip.reach, row.reach, 2e-8) << "at gamma = " << row.gamma;
  }
}
TEST(ClosedForms, AnAlmostRigidElasticaIsABeamWithSmallDeflection) {
  const Real gamma = 1e-3;  // the beam: drop w L^4 / (8 B), tip angle w L^3 / (6 B)
  EXPECT_NEAR(heavy_elastica(gamma).drop, gamma / 8, 1e-6 * gamma);
  EXPECT_NEAR(heavy_elastica(gamma).angle, gamma / 6, 1e-6 * gamma);
  EXPECT_EQ(heavy_elastica(0).drop, 0);
}
TEST(ClosedForms, AVeryHeavyElasticaHangsDown) {
  const ElasticaTip tip = heavy_elastica(1000);
  EXPECT_GT(tip.drop, 0.95);
  EXPECT_LT(tip.drop + tip.reach, 1.1);
  EXPECT_NEAR(tip.angle, std::numbers::pi / 2, 1e-6);
}
TEST(ClosedForms, AGammaThatTheShootingDoesNotCoverIsRefused) {
  EXPECT_THROW(heavy_elastica(-1), SettingsError);
  EXPECT_THROW(heavy_elastica(std::nan("")), SettingsError);
}
TEST(ClosedForms, HalfATurnAtFrictionThreeTenthsMultipliesThePull) {
  EXPECT_NEAR(capstan_ratio(0.3, std::numbers::pi), 2.56633, 5e-6);  // published table, five digits
}

TEST(ClosedForms, PeelForceFollowsKendall) {  // checks.md, part 5: the 19-mm vinyl tape, R = 264.12 J/m^2
  const std::pair<Real, Real> known[] = {{0, 41.428}, {30, 24.431}, {60, 9.508}, {90, 4.947}, {120, 3.324}, {180, 2.500}};
  for (const auto& [degrees, force] : known)
    EXPECT_NEAR(0.019 * peel_force(264.12, degrees * std::numbers::pi / 180, 50e6 * 1.8e-4), force, 2e-4 * force) << degrees;
}
