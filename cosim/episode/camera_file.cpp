#include "cosim/episode/camera_file.hpp"

#include <fmt/format.h>

#include "cosim/scene/scene_file.hpp"
#include "tape/math/rotation.hpp"

namespace cosim {
namespace {
constexpr Range kCoefficient = Range::closed(-1e4, 1e4);  // [1]

/// OpenCV's and ROS's form: they name the same things alike.
Calibration read_matrices(const Reader& root) {
  if (const Reader model = root["distortion_model"]) choose(model, {"plumb_bob", "radtan"});
  if (const Reader fisheye = root["fisheye_model"]; fisheye && fisheye.integer(Range::any()) != 0)
    fisheye.fail("is another lens (allowed: 0, the lens with k1, k2, p1, p2, k3)");
  const Reader matrix = root["camera_matrix"]["data"];
  const std::vector<Real> k = matrix.numbers(9, Range::any(), "px");
  if (k[1] != 0 || k[3] != 0 || k[6] != 0 || k[7] != 0 || k[8] != 1) matrix.fail("is no matrix [fx, 0, cx, 0, fy, cy, 0, 0, 1]");
  Calibration calibration{.fx = k[0], .fy = k[4], .cx = k[2], .cy = k[5]};
  calibration.width = root["image_width"].integer(Range::closed(1, 16384), "px");
  calibration.height = root["image_height"].integer(Range::closed(1, 16384), "px");
  const Reader coefficients = root["distortion_coefficients"]["data"];
  if (!coefficients) coefficients.fail("missing (allowed: k1, k2, p1, p2 and perhaps k3; all 0 for a lens without distortion)");
  calibration.lens = read_distortion(coefficients);
  return calibration;
}

PlacedCamera read_own(const Reader& camera) {
  PlacedCamera placed;
  placed.calibration.fields([&](const char* key, auto&, const char*, Range, const char*) {
    if (!camera[key]) camera[key].fail("missing; a calibrated camera has fx, fy, cx, cy, width and height, or OpenCV's camera_matrix");
  });
  camera.read(placed.calibration);
  placed.calibration.lens = read_distortion(camera["distortion"]);
  placed.X_WC.position = camera["position"].vector_or(Vec3::Zero(), Range::any(), "m");
  placed.X_WC.rotation = rotation_exp(camera["rotation"].vector_or(Vec3::Zero(), Range::any(), "rad"));
  return placed;
}
}  // namespace

Distortion read_distortion(const Reader& list) {
  if (!list) return {};
  const std::size_t count = list.items().size();
  if (count != 4 && count != 5) list.fail("is another lens (allowed: k1, k2, p1, p2 and perhaps k3)");
  std::vector<Real> k = list.numbers(count, kCoefficient, "");
  k.resize(5, 0.0);
  return {.k1 = k[0], .k2 = k[1], .p1 = k[2], .p2 = k[3], .k3 = k[4]};
}

PlacedCamera load_camera(const std::filesystem::path& file) {
  std::string text = read_whole_file(file, file.string());
  if (text.starts_with("%YAML:")) text[0] = '#';  // OpenCV's first line is no YAML
  const SceneFile yaml = SceneFile::parse(text, file);
  PlacedCamera placed;
  if (yaml["camera_matrix"]) {
    placed.calibration = read_matrices(yaml.root());
  } else {
    const Reader section = yaml["camera"];
    placed = read_own(section ? section : yaml.root());
    yaml.require_all_used();
  }
  try {
    require_valid(placed.calibration, "camera");
  } catch (const SettingsError& e) {
    throw InputError(file.string() + ": " + e.what());
  }
  return placed;
}
}  // namespace cosim
