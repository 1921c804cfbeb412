#include "apps/score/landmark.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <numbers>

#include "tape/math/rotation.hpp"
using namespace tape;
using namespace tape::score;
using cosim::LandmarkKind;
using render::Camera;

namespace {
constexpr Real kRadius = 0.019;
const Camera kCamera = Camera::make(cosim::Calibration{.fx = 600, .fy = 600, .cx = 424, .cy = 240}, {});
const Camera kPlaced =
    Camera::make(cosim::Calibration{.fx = 610, .fy = 590, .cx = 420, .cy = 250}, {rotation_exp({2.1, 0.3, -0.2}), {0.1, -0.4, 0.5}});

Vec3 tilted(Real degrees) { return rotation_exp({0, degrees * std::numbers::pi / 180, 0}) * Vec3::UnitZ(); }

/// The centre by the conic itself and not its dual: M = K^-T Q K^-1 with Q = A^T A - r^2 n n^T, A = (n.C) I - C n^T; centre -M22^-1 m.
Vec2 centre_of_conic(const Camera& camera, const Vec3& p_WC, const Vec3& n_W, Real radius) {
  const Vec3 C = camera.from_world(p_WC), n = camera.X_WC.rotation.transpose() * n_W;
  const Mat3 A = n.dot(C) * Mat3::Identity() - C * n.transpose(), Q = A.transpose() * A - radius * radius * n * n.transpose();
  Mat3 K;
  K << camera.fx, 0, camera.cx, 0, camera.fy, camera.cy, 0, 0, 1;
  const Mat3 M = K.inverse().transpose() * Q * K.inverse();
  return -M.topLeftCorner<2, 2>().inverse() * M.topRightCorner<2, 1>();
}

/// Middle between the outermost points of the ellipse to the left and right, above and below: its centre, by its symmetry. From points on
/// the circle, so close that the outermost is found to 1e-7 px.
Vec2 middle_of_extent(const Camera& camera, const Vec3& p_W, const Vec3& n_W, Real radius) {
  const Vec3 x = n_W.unitOrthogonal(), y = n_W.cross(x);
  Eigen::AlignedBox<Real, 2> box;
  constexpr int kPoints = 40'000;
  for (int i = 0; i < kPoints; ++i) {
    const Real angle = 2 * std::numbers::pi * i / kPoints;
    box.extend(camera.project(p_W + radius * (std::cos(angle) * x + std::sin(angle) * y)));
  }
  return box.center();
}

Hub hub_at(const Vec3& rotation, const Vec3& position) { return {{rotation_exp(rotation), position}, kRadius, 0.02}; }
}  // namespace

TEST(Landmark, TheEllipseCentreMissesTheProjectedCentreByTheKnownBias) {
  const Vec2 centre = *circle_centre(kCamera, {0, 0, 0.4}, tilted(60), kRadius);
  EXPECT_NEAR((centre - Vec2(424, 240)).norm(), 0.587184572, 0.5e-9);
}
TEST(Landmark, TheEllipseCentreIsThatOfTheConicAndTheMiddleOfItsExtent) {
  for (Real degrees : {0.0, 20.0, 60.0, 89.0})
    for (const Vec3& p_C : {Vec3(0, 0, 0.4), Vec3(0.1, -0.06, 0.3), Vec3(-0.2, 0.1, 0.9)}) {
      const Vec3 p_W = apply(kPlaced.X_WC, p_C), n_W = kPlaced.X_WC.rotation * tilted(degrees);
      const Vec2 centre = *circle_centre(kPlaced, p_W, n_W, kRadius);
      EXPECT_LT((centre - centre_of_conic(kPlaced, p_W, n_W, kRadius)).norm(), 1e-8) << degrees;
      EXPECT_LT((centre - middle_of_extent(kPlaced, p_W, n_W, kRadius)).norm(), 1e-6) << degrees;
    }
}
TEST(Landmark, ACircleSeenEdgeOnHasTheMiddleOfItsSegment) {
  // In the plane y = 0 about (0.1, 0, 0.4): x/z is extreme on the tangents from the camera, at 14.036 -+ 2.6414 degrees, where
  // tan 14.036 = 1/4 and sin 2.6414 = 0.019 / |C|.
  const Real middle = std::atan(0.25), half = std::asin(0.019 / std::hypot(0.1, 0.4));
  const Vec2 centre = *circle_centre(kCamera, {0.1, 0, 0.4}, Vec3::UnitY(), kRadius);
  EXPECT_NEAR(centre.x(), 424 + 300 * (std::tan(middle - half) + std::tan(middle + half)), 1e-9);
  EXPECT_NEAR(centre.y(), 240, 1e-9);
}
TEST(Landmark, ACircleThatReachesBehindTheCameraHasNoEllipse) {
  EXPECT_TRUE(circle_centre(kCamera, {0, 0, 0.0191}, Vec3::UnitX(), kRadius));
  EXPECT_FALSE(circle_centre(kCamera, {0, 0, 0.0189}, Vec3::UnitX(), kRadius));
  EXPECT_FALSE(circle_centre(kCamera, {0, 0, -0.4}, Vec3::UnitZ(), kRadius));
  EXPECT_FALSE(hub_landmark(kCamera, hub_at({0, 0, 0}, {0, 0, -0.4}), LandmarkKind::side_box));
}
TEST(Landmark, TheRimThatFacesTheCameraIsTheNearOneWhicheverWayTheHubIsTurned) {
  // The camera looks along +z: the facing rim lies at z = 0.39, the other at 0.41.
  for (const Vec3& rotation : {Vec3(0, 0, 0), Vec3(std::numbers::pi, 0, 0)}) {
    const Hub hub = hub_at(rotation, {0.1, 0, 0.4});
    EXPECT_EQ(facing_end(kCamera, hub), rotation.norm() > 0 ? 1 : -1);
    const Vec2 rim = *hub_landmark(kCamera, hub, LandmarkKind::rim);
    EXPECT_LT((rim - Vec2(424 + 600 * 0.1 / 0.39, 240)).norm(), 1e-9) << "seen face-on the bias is zero";
    for (const Vec2& point : rim_outline(kCamera, hub)) EXPECT_NEAR((point - rim).norm(), 600 * kRadius / 0.39, 1e-9);
  }
}
TEST(Landmark, BetweenThePlanesOfItsEndsTheCameraSeesNoRim) {
  const Vec3 on_its_side(std::numbers::pi / 2, 0, 0);  // axis along -y
  EXPECT_EQ(facing_end(kCamera, hub_at(on_its_side, {0, 0.009, 0.4})), 0);
  EXPECT_EQ(facing_end(kCamera, hub_at(on_its_side, {0, 0.011, 0.4})), 1);
  EXPECT_EQ(facing_end(kCamera, hub_at(on_its_side, {0, -0.011, 0.4})), -1);
  const Vec2 nearer = *hub_landmark(kCamera, hub_at(on_its_side, {0, 0.009, 0.4}), LandmarkKind::rim);
  EXPECT_LT(nearer.y(), 240) << "the rim at y = -1 mm, not that at 19 mm";
}
TEST(Landmark, TheMiddleOfTheHubsBoxIsTheHubsMiddleWhateverTheAxes) {
  const Hub hub = hub_at({0.4, -1.1, 0.7}, {0.05, 0.03, 0.45});
  for (const Vec3& axes : {Vec3(0, 0, 0), Vec3(0.3, 0.2, -0.9)}) {
    const Mat3 R = rotation_exp(axes);
    Eigen::AlignedBox<Real, 3> box;
    for (int i = 0; i < 96; ++i)
      for (Real z : {-0.01, 0.01})
        box.extend(R.transpose() * apply(hub.X_WH, {0.0211 * std::cos(2 * std::numbers::pi * i / 96),
                                                    0.0211 * std::sin(2 * std::numbers::pi * i / 96), z}));
    const Vec2 middle = kCamera.project(R * box.center());
    EXPECT_LT((*hub_landmark(kCamera, hub, LandmarkKind::side_box) - middle).norm(), 1e-9);
  }
}
