#pragma once
#include <filesystem>

#include "cosim/episode/calibration.hpp"
#include "cosim/scene/reader.hpp"

namespace cosim {
struct PlacedCamera {
  Calibration calibration;
  Pose X_WC;  ///< camera in the world
};

/// List [k1, k2, p1, p2, k3], or [k1, k2, p1, p2]; no distortion where there is none.
Distortion read_distortion(const Reader& list);

/// A calibrated camera out of a YAML file of one of three forms:
///  - the project's own: fx, fy, cx, cy, width, height, distortion, position, rotation, alone or in a section `camera`;
///  - OpenCV's (%YAML:1.0 with !!opencv-matrix) and ROS's (camera_info): image_width, image_height, camera_matrix,
///    distortion_coefficients of four or five numbers, distortion_model plumb_bob or radtan where it is there. These hold no pose: the
///    camera stands in the origin.
/// @throws InputError "file:line: key = value: reason" for a file of another form or a model of another lens
PlacedCamera load_camera(const std::filesystem::path& file);
}  // namespace cosim
