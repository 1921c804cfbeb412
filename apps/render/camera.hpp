#pragma once
#include <string>

#include "cosim/episode/calibration.hpp"
#include "tape/core/settings.hpp"
#include "tape/core/types.hpp"

namespace tape::render {
using Bounds = Eigen::AlignedBox<Real, 3>;  // [m]

/// Camera of a scene file by where it stands and what it looks at.
struct LookAtSettings {
  Vec3 eye{0.5, -0.6, 0.5};  ///< [m]
  Vec3 target{0, 0, 0};      ///< [m]   shown in the middle of the picture
  Vec3 up{0, 0, 1};          ///< [1]   drawn upwards
  Real fov = 35;             ///< [deg] vertical field of view
  std::string follow = {};   ///< thing that the camera moves along with, without turning
  std::string mount = {};    ///< body, or link of a robot, in whose frame eye, target and up are
  template <class F>
  void fields(F&& f) {
    f("eye", eye, "m", Range::any(), "where the camera stands");
    f("target", target, "m", Range::any(), "point in the middle of the picture");
    f("up", up, "", Range::any(), "direction drawn upwards");
    f("fov", fov, "deg", Range::closed(1, 150), "vertical field of view");
    f("follow", follow, "", Range::any(), "body or strip that the camera moves along with, or tape.tip; it does not turn");
    f("mount", mount, "", Range::any(),
      "body, or link or frame as robot:link, that the camera is fixed to: eye, target and up are in its frame");
  }
};

/// Calibrated camera of a scene file: intrinsics and pose in the world.
struct PinholeSettings {
  cosim::Calibration calibration;  ///< pictures are drawn as an ideal lens of these focal lengths and principal point makes them
  Vec3 position{0, 0, 0};          ///< [m]   camera in the world
  Vec3 rotation{0, 0, 0};          ///< [rad] rotation vector from camera to world axes
  std::string mount = {};          ///< body, or link of a robot, whose frame stands for the world in position and rotation
  std::string name = "camera";     ///< in an episode that is recorded
  template <class F>
  void fields(F&& f) {
    calibration.fields(f);
    f("position", position, "m", Range::any(), "position in the world");
    f("rotation", rotation, "rad", Range::any(), "rotation vector from camera axes to world axes");
    f("mount", mount, "", Range::any(),
      "body, or link or frame as robot:link, that the camera is fixed to: position and rotation are in its frame");
    f("name", name, "", Range::any(), "of a calibrated camera, in an episode that is recorded");
  }
};

/// Pinhole camera; a point p_C seen from it falls on u = fx x/z + cx, v = fy y/z + cy [px] (axes and pixels of cosim::Calibration).
struct Camera {
  int width, height;    ///< [px]
  Real fx, fy, cx, cy;  ///< [px]
  Pose X_WC;

  /// @throws SettingsError for a value out of range, InputError where eye, target and up span no plane
  static Camera make(const LookAtSettings& settings, int width, int height);
  static Camera make(const PinholeSettings& settings);
  /// The ideal camera that takes the undistorted picture of a calibrated one: the same focal lengths and principal point, no lens.
  static Camera make(const cosim::Calibration& calibration, const Pose& X_WC);
  /// World point in camera axes [m].
  Vec3 from_world(const Vec3& p_W) const { return X_WC.rotation.transpose() * (p_W - X_WC.position); }
  /// Pixel (u, v) on which a world point falls. Assumes that it lies in front of the camera.
  Vec2 project(const Vec3& p_W) const;
  /// Matrix from world to OpenGL clip coordinates for a depth that is near/z: 1 at the near plane, 0 at infinity, where floating
  /// point is densest, so that depth is resolved to 1e-7 of the distance.  @param near  [m]
  Eigen::Matrix4d clip_from_world(Real near) const;
};

/// Three-quarter view in which `bounds` (of a whole motion) just fills a picture of this size, with a margin.
LookAtSettings overview(const Bounds& bounds, int width, int height);
}  // namespace tape::render
