#include "cosim/episode/calibration.hpp"

#include <gtest/gtest.h>

using namespace cosim;

namespace {
const Distortion kBarrel{.k1 = -.28, .k2 = .09, .p1 = .0007, .p2 = -.0004, .k3 = -.012};
const Distortion kPincushion{.k1 = 0.35, .k2 = 0.12, .p1 = -.002, .p2 = .001, .k3 = 0.05};
/// r (1 - r^2/3) turns back at r = 1, where it is 2/3.
const Distortion kFold{.k1 = -1.0 / 3};
const Calibration kEgo{.fx = 610, .fy = 608, .cx = 424.3, .cy = 238.9, .lens = kBarrel};
}  // namespace

TEST(Calibration, DistortionHasThePublishedValues) {
  EXPECT_LT((distort(kBarrel, {.3, .2}) - Vec2(.289488390800, .193117927200)).norm(), 1e-12);
  EXPECT_LT((distort(kBarrel, {.5, -.35}) - Vec2(.453189911031, -.317076487722)).norm(), 1e-12);
}
TEST(Calibration, TheSlopeIsThatOfTheDistortion) {
  for (const Distortion& lens : {kBarrel, kPincushion})
    for (const Vec2& x : {Vec2(0, 0), Vec2(.3, .2), Vec2(-.5, .35), Vec2(.1, -.6)}) {
      constexpr Real kStep = 1e-6;
      Mat2 slope;
      for (int i = 0; i < 2; ++i)
        slope.col(i) = (distort(lens, x + kStep * Vec2::Unit(i)) - distort(lens, x - kStep * Vec2::Unit(i))) / (2 * kStep);
      EXPECT_LT((distortion_slope(lens, x) - slope).norm(), 1e-9);
    }
}
TEST(Calibration, UndistortingRevertsTheLensInEveryPixelOfThePicture) {
  for (const Distortion& lens : {kBarrel, kPincushion, Distortion{}}) {
    Calibration camera = kEgo;
    camera.lens = lens;
    for (int u = 0; u < camera.width; u += 53)
      for (int v = 0; v < camera.height; v += 37)
        EXPECT_LT((camera.distorted(camera.undistorted(Vec2(u, v))) - Vec2(u, v)).norm(), 1e-6) << u << ", " << v;
  }
}
TEST(Calibration, UndistortingFindsTheIdealPointToAMillionthOfAPixel) {
  for (const Vec2& x : {Vec2(.3, .2), Vec2(.5, -.35), Vec2(-.6, .38)}) {
    const std::optional<Vec2> found = undistort(kBarrel, distort(kBarrel, x));
    ASSERT_TRUE(found);
    EXPECT_LT(kEgo.fx * (*found - x).norm(), 1e-6);
  }
}
TEST(Calibration, APointJustInsideTheFoldIsFoundAndOneBeyondIsNot) {
  for (Real r : {0.9, 0.99, 0.999}) {
    const std::optional<Vec2> found = undistort(kFold, {r * (1 - r * r / 3), 0});
    ASSERT_TRUE(found) << r;
    EXPECT_NEAR(found->x(), r, 1e-9) << "and not the root beyond the fold";
  }
  EXPECT_FALSE(undistort(kFold, {0.667, 0}));
  EXPECT_FALSE(undistort(kFold, {0, -5}));
  const Distortion rises_again{.k1 = -0.5, .k2 = 0.1};  // r - r^3/2 + r^5/10 has a summit of 0.6 at r = 1, and a root for more at r > 1.41
  EXPECT_TRUE(undistort(rises_again, {0.599, 0}));
  EXPECT_FALSE(undistort(rises_again, {0.61, 0}));
  EXPECT_FALSE(undistort(rises_again, {0, 2}));
  EXPECT_FALSE(folds_before(kFold, {0, 0.99}));
  EXPECT_TRUE(folds_before(kFold, {0, 1.01}));
  EXPECT_TRUE(folds_before(kFold, {3, 0})) << "where the slope is positive again";
  EXPECT_THROW((Calibration{.fx = 500, .lens = kFold}.undistorted({900, 240})), InputError);
}
TEST(Calibration, APointProjectsAsTheFormulaSaysAndNotFromBehindTheCameraOrBeyondTheFold) {
  const std::optional<Vec2> pixel = kEgo.project({0.15, 0.1, 0.5});  // at (.3, .2)
  ASSERT_TRUE(pixel);
  EXPECT_LT((*pixel - Vec2(610 * .289488390800 + 424.3, 608 * .193117927200 + 238.9)).norm(), 1e-9);
  EXPECT_FALSE(kEgo.project({0.1, 0.1, -0.5}));
  EXPECT_FALSE(kEgo.project({0.1, 0.1, 0}));
  EXPECT_FALSE((Calibration{.lens = kFold}.project({1, 0, 0.5})));
}
TEST(Calibration, APictureReachesHalfAPixelBeyondTheCentresOfItsBorderPixels) {
  EXPECT_TRUE(kEgo.holds({-0.5, 479.5}));
  EXPECT_FALSE(kEgo.holds({-0.51, 100}));
  EXPECT_FALSE(kEgo.holds({847.6, 100}));
  EXPECT_FALSE(kEgo.holds({100, 479.6}));
}
TEST(Calibration, OfAnotherResolutionIsRefused) {
  EXPECT_NO_THROW(require_resolution(kEgo, 848, 480, "ego.yaml", "left01.jpg"));
  try {
    require_resolution(kEgo, 640, 480, "ego.yaml", "left01.jpg");
    ADD_FAILURE() << "accepted";
  } catch (const InputError& e) {
    EXPECT_STREQ(e.what(), "ego.yaml: is a calibration for pictures of 848 x 480 px, left01.jpg has 640 x 480 px (allowed: the same)");
  }
}
