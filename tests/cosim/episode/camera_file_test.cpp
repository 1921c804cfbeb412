#include "cosim/episode/camera_file.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <fstream>
#include <string>

#include "tests/robot/support/real_data.hpp"
using namespace cosim;
namespace fs = std::filesystem;

namespace {
PlacedCamera load(const std::string& text) {
  const fs::path file = fs::temp_directory_path() / ("camera_file_test_" + std::to_string(getpid()) + ".yaml");
  std::ofstream(file) << text;
  try {
    PlacedCamera camera = load_camera(file);
    fs::remove(file);
    return camera;
  } catch (...) {
    fs::remove(file);
    throw;
  }
}
void expect_refused(const std::string& text, const std::string& says) {
  try {
    load(text);
    ADD_FAILURE() << "accepted: " << text;
  } catch (const InputError& e) {
    EXPECT_NE(std::string(e.what()).find(says), std::string::npos) << e.what();
  }
}
const std::string kOwn = "fx: 610\nfy: 608\ncx: 424\ncy: 239\nwidth: 848\nheight: 480\n";
const std::string kRos = R"(image_width: 848
image_height: 480
camera_name: ego
camera_matrix:
  rows: 3
  cols: 3
  data: [610.5, 0.0, 424.1, 0.0, 608.25, 239.2, 0.0, 0.0, 1.0]
distortion_model: plumb_bob
distortion_coefficients:
  rows: 1
  cols: 5
  data: [-0.28, 0.09, 0.0007, -0.0004, -0.012]
rectification_matrix:
  rows: 3
  cols: 3
  data: [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0]
)";
std::string replaced(std::string text, const std::string& old, const std::string& by) {
  return text.replace(text.find(old), old.size(), by);
}
}  // namespace

TEST(CameraFile, TheProjectsFormHasDistortionAndPose) {
  const PlacedCamera camera = load(
      "camera:\n  {fx: 610, fy: 608, cx: 424, cy: 239, width: 640, height: 480, distortion: [-0.28, 0.09, 0.0007, -0.0004, -0.012],\n"
      "   position: [1, 2, 3], rotation: [0, 0, 1.5707963267948966]}\n");
  EXPECT_EQ(camera.calibration.fy, 608);
  EXPECT_EQ(camera.calibration.width, 640);
  EXPECT_EQ(camera.calibration.lens.p2, -0.0004);
  EXPECT_EQ(camera.calibration.lens.k3, -0.012);
  EXPECT_EQ(camera.X_WC.position, Vec3(1, 2, 3));
  EXPECT_LT((camera.X_WC.rotation * Vec3::UnitX() - Vec3::UnitY()).norm(), 1e-15);
  EXPECT_EQ(load(kOwn).calibration.lens.k1, 0);
}
TEST(CameraFile, AFileOfRosIsRead) {
  const Calibration camera = load(kRos).calibration;
  EXPECT_EQ(camera.fx, 610.5);
  EXPECT_EQ(camera.fy, 608.25);
  EXPECT_EQ(camera.cx, 424.1);
  EXPECT_EQ(camera.cy, 239.2);
  EXPECT_EQ(camera.lens.k2, 0.09);
  EXPECT_EQ(camera.lens.p1, 0.0007);
}
TEST(CameraFile, AFileOfOpenCvIsRead) {
  const std::string matrix =
      "camera_matrix: !!opencv-matrix\n   rows: 3\n   cols: 3\n   dt: d\n   data: [ 5.36e+02, 0., 342., 0.,\n"
      "       5.35e+02, 235.5, 0., 0., 1. ]\n";
  const Calibration camera = load("%YAML:1.0\n---\nimage_width: 640\nimage_height: 480\nflags: 2\n" + matrix +
                                  "distortion_coefficients: !!opencv-matrix\n   rows: 5\n   cols: 1\n   dt: d\n"
                                  "   data: [ -2.66e-01, -3.8e-02,\n       1.7e-03, -2.8e-04, 2.3e-01 ]\n")
                                 .calibration;
  EXPECT_EQ(camera.fx, 536);
  EXPECT_EQ(camera.height, 480);
  EXPECT_EQ(camera.lens.k1, -0.266);
  EXPECT_EQ(camera.lens.p2, -2.8e-4);
  EXPECT_EQ(camera.lens.k3, 0.23);
}
TEST(CameraFile, TheCalibrationOfARealCameraIsRead) {
  const fs::path file = robot::test::real_data() / "realsense_d455_848x480" / "d455_color_848x480.yaml";
  if (!fs::exists(file)) GTEST_SKIP() << file << " is absent: set TAPE_REAL_DATA";
  const Calibration camera = load_camera(file).calibration;
  EXPECT_EQ(camera.width, 848);
  EXPECT_EQ(camera.fx, 416.85223429743274);
  EXPECT_EQ(camera.lens.p2, 0.000431371425853453);
  EXPECT_EQ(camera.lens.k3, 0);
}
TEST(CameraFile, BadOnesAreRefusedByLineAndKey) {
  expect_refused(replaced(kRos, "plumb_bob", "equidistant"), ":8: distortion_model = equidistant: unknown (allowed: plumb_bob, radtan)");
  expect_refused(replaced(kRos, "[-0.28, 0.09, 0.0007, -0.0004, -0.012]", "[0, 0, 0, 0, 0, 0, 0, 0]"), "distortion_coefficients.data");
  expect_refused(replaced(kRos, "distortion_coefficients", "dist_coeffs"), "distortion_coefficients.data");
  expect_refused(replaced(kRos, "-0.28", ".nan"), "distortion_coefficients.data.0 = .nan");
  expect_refused(replaced(kRos, "[610.5, 0.0,", "[610.5, 0.3,"), "camera_matrix.data");
  expect_refused(replaced(kRos, "610.5", "-610.5"), "camera.fx = -610.5");
  expect_refused(replaced(kRos, "image_width: 848\n", ""), "image_width: missing");
  expect_refused(replaced(kOwn, "cx: 424\n", ""), "cx: missing");
  expect_refused(kOwn + "distortion: [1]\n", "distortion");
  expect_refused(kOwn + "distorsion: [0, 0, 0, 0]\n", "did you mean distortion?");
  expect_refused("<?xml version=\"1.0\"?>\n<opencv_storage></opencv_storage>\n", ":1: ");
}
