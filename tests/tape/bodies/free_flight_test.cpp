#include "tape/bodies/free_flight.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <numbers>

#include "tape/math/rotation.hpp"
using namespace tape;

namespace {
// Principal moments of inertia 1, 2, 3 kg m^2: second moments (I2 + I3 - I1)/2 and so on, in cyclic order.
const Mat3 kSecond = Vec3(2, 1, 0).asDiagonal();
Real kinetic(const Mat3& R, const Vec3& L) { return L.dot((R * inertia_tensor(kSecond) * R.transpose()).inverse() * L) / 2; }
}  // namespace

TEST(FreeFlight, InertiaTensorFollowsFromSecondMoments) { EXPECT_TRUE(inertia_tensor(kSecond).isApprox(Mat3(Vec3(1, 2, 3).asDiagonal()))); }

TEST(FreeFlight, SpinAboutAPrincipalAxisTurnsByRateTimesTime) {
  const Real rate = 3, dt = 0.2;
  const Mat3 R = free_flight(Mat3::Identity(), Vec3(0, 0, 3 * rate), kSecond, dt);
  // The Cayley map turns by 2 atan(h w / 2) in each substep h: an error of (h w)^3 / 12 each, at h w <= 0.05.
  EXPECT_NEAR(rotation_log(R).z(), rate * dt, 12 * std::pow(0.05, 3) / 12);
}

TEST(FreeFlight, AnAsymmetricBodyFlipsAndKeepsEnergyToRoundOff) {
  Mat3 R = Mat3::Identity();
  const Vec3 L = inertia_tensor(kSecond) * Vec3(1e-3, 10, 0);  // spin about the middle axis is unstable (Dzhanibekov)
  const Real before = kinetic(R, L);
  Real lowest = 1;
  for (int k = 0; k < 500; ++k) {
    R = free_flight(R, L, kSecond, 0.01);
    lowest = std::fmin(lowest, (R * Vec3::UnitY()).dot(L.normalized()));
    EXPECT_NEAR(kinetic(R, L), before, 1e-11 * before);
  }
  EXPECT_LT(lowest, -0.9);
  EXPECT_NEAR((R.transpose() * R - Mat3::Identity()).norm(), 0, 1e-12);
}
