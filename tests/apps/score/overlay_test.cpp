#include "apps/score/overlay.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "cosim/episode/camera_file.hpp"
#include "tests/robot/support/real_data.hpp"
using namespace tape;
using namespace tape::score;
namespace fs = std::filesystem;

namespace {
/// Middle of the pixels that a drawing has changed, weighted with the change.
Vec2 changed_middle(const render::Picture& picture) {
  Vec2 sum = Vec2::Zero();
  Real weight = 0;
  for (int y = 0; y < picture.height; ++y)
    for (int x = 0; x < picture.width; ++x)
      if (const Real change = picture.at(x, y)[0] + picture.at(x, y)[1] + picture.at(x, y)[2]; change > 0)
        sum += change * Vec2(x, y), weight += change;
  return sum / weight;
}
int changed(const render::Picture& picture) {
  int n = 0;
  for (int y = 0; y < picture.height; ++y)
    for (int x = 0; x < picture.width; ++x) n += picture.at(x, y)[0] + picture.at(x, y)[1] + picture.at(x, y)[2] > 0;
  return n;
}
}  // namespace

TEST(Overlay, MarksStandWhereTheLandmarksAre) {
  render::Picture real(200, 100), both(200, 100);
  draw_landmarks(real, {.real{60.25, 40.5}, .in_front = false});
  EXPECT_LT((changed_middle(real) - Vec2(60.25, 40.5)).norm(), 0.2);
  draw_landmarks(both, {.real{60, 40}, .simulated{60, 40}});
  EXPECT_LT((changed_middle(both) - Vec2(60, 40)).norm(), 0.2);
  EXPECT_GT(changed(both), changed(real)) << "the cross is inside the ring";
}
TEST(Overlay, TheRingOfAnEstimatedLandmarkHasAGap) {
  render::Picture certain(200, 100), estimated(200, 100);
  draw_landmarks(certain, {.real{60, 40}, .in_front = false});
  draw_landmarks(estimated, {.real{60, 40}, .estimated = true, .in_front = false});
  EXPECT_GT(certain.at(65, 35)[0], 100) << "7 px up to the right";
  EXPECT_EQ(estimated.at(65, 35)[0], 0);
  EXPECT_GT(estimated.at(55, 45)[0], 100);
}
TEST(Overlay, MarksOutsideOfThePictureLeaveItAlone) {
  render::Picture picture(200, 100);
  draw_landmarks(picture, {.real{-300, 40}, .simulated{-500, 900}});
  EXPECT_EQ(changed(picture), 0);
}
TEST(Overlay, TheRimIsDrawnWhereTheCameraSeesIt) {
  // Face on: a circle of 600 * 0.019 / 0.39 = 29.2 px.
  const auto camera = render::Camera::make(cosim::Calibration{.fx = 600, .fy = 600, .cx = 100, .cy = 60, .width = 200, .height = 120}, {});
  render::Picture picture(200, 120);
  draw_rim(picture, camera, {{Mat3::Identity(), {0, 0, 0.4}}, 0.019, 0.02});
  ASSERT_GT(changed(picture), 150);
  for (int y = 0; y < picture.height; ++y)
    for (int x = 0; x < picture.width; ++x)
      EXPECT_TRUE(picture.at(x, y)[2] <= 100 || std::abs(std::hypot(x - 100, y - 60) - 29.2) < 1.5) << x << ", " << y;
}
TEST(Overlay, BothPicturesShowThroughEachOther) {
  render::Picture a(2, 1), b(2, 1);
  a.rgb = {200, 0, 0, 40, 40, 40}, b.rgb = {0, 100, 0, 40, 80, 40};
  EXPECT_EQ(blended(a, b).rgb, (std::vector<std::uint8_t>{100, 50, 0, 40, 60, 40}));
  EXPECT_THROW(blended(a, render::Picture(3, 1)), InputError);
}
TEST(Overlay, UndistortingAPictureMovesWhatItShowsToWhereTheIdealCameraSeesIt) {
  const cosim::Calibration camera{
      .fx = 300, .fy = 300, .cx = 160, .cy = 120, .width = 320, .height = 240, .lens = {.k1 = -0.2, .k2 = 0.04}};
  render::Picture photograph(320, 240);
  const Vec2 ideal(60, 50), seen = camera.distorted(ideal);
  ASSERT_GT((seen - ideal).norm(), 3);
  for (int y = 0; y < 240; ++y)
    for (int x = 0; x < 320; ++x)  // a soft white spot
      for (int c = 0; c < 3; ++c)
        photograph.at(x, y)[c] = static_cast<std::uint8_t>(255 * std::exp(-(Vec2(x, y) - seen).squaredNorm() / 8));
  EXPECT_LT((changed_middle(undistorted(photograph, camera)) - ideal).norm(), 0.1);
  EXPECT_THROW(undistorted(render::Picture(640, 480), camera), InputError);
}
TEST(Overlay, ARealPhotographIsReadAndUndistorted) {
  const fs::path folder = robot::test::real_data() / "opencv_calib";
  if (!fs::exists(folder)) GTEST_SKIP() << folder << " is absent: set TAPE_REAL_DATA";
  const cosim::Calibration camera = cosim::load_camera(folder / "left_intrinsics.yml").calibration;
  const render::Picture photograph = read_photograph(folder / "left01.jpg", camera);
  EXPECT_EQ(photograph.width, 640);
  EXPECT_EQ(undistorted(photograph, camera).height, 480);
  EXPECT_THROW(read_photograph(folder / "left01.jpg", cosim::Calibration{}), InputError) << "848 x 480";
  EXPECT_THROW(read_photograph(folder / "left_intrinsics.yml", camera), InputError);
}
