#include "tape/math/rotation.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
using namespace tape;

namespace {
const Vec3 kAxes[] = {Vec3(1, 0, 0), Vec3(0, 0, -1), Vec3(1, -2, 2) / 3};
constexpr Real kAngles[] = {0, 1e-12, 1e-8, 1e-4, 1.0001e-4, 0.3, 1, 3, std::numbers::pi - 1e-9};
}  // namespace

TEST(Rotation, TheExponentialTurnsAboutItsAxisByItsAngle) {
  for (const Vec3& axis : kAxes)
    for (const Real angle : kAngles) {
      const Mat3 R = rotation_exp(angle * axis);
      EXPECT_LT((R * R.transpose() - Mat3::Identity()).norm(), 1e-14) << angle;
      EXPECT_LT((R * axis - axis).norm(), 1e-14) << angle;
      const Vec3 across = axis.cross(Vec3(0.3, 0.5, -0.2)).normalized();  // turns in the plane of itself and axis x across
      EXPECT_LT((R * across - (std::cos(angle) * across + std::sin(angle) * axis.cross(across))).norm(), 1e-14) << angle;
      EXPECT_LT((rotate(angle * axis, across) - R * across).norm(), 1e-15) << angle;
    }
}
TEST(Rotation, TheLogarithmIsItsInverse) {
  for (const Vec3& axis : kAxes)
    for (const Real angle : kAngles) EXPECT_LT((rotation_log(rotation_exp(angle * axis)) - angle * axis).norm(), 1e-7) << angle;
}
TEST(Rotation, TheDeviationOfAnArcFromItsChordIsTheLargestThatItHas) {
  for (const Real angle : {1e-3, 0.5, 3.0, 6.0}) {
    Real most = 0;
    for (int k = 0; k <= 1000; ++k) {  // from the chord between the ends of an arc of radius 2, symmetric about x
      const Real a = angle * (k / 1000.0 - 0.5);
      most = std::fmax(most, 2 * std::cos(a) - 2 * std::cos(angle / 2));
    }
    EXPECT_NEAR(chord_deviation(2, angle), most, 1e-6 * most) << angle;
  }
  EXPECT_EQ(chord_deviation(2, 100), 4);
}
