#include "apps/render/camera.hpp"

#include <algorithm>
#include <numbers>

#include "tape/math/rotation.hpp"

namespace tape::render {
namespace {
constexpr Real kRadians = std::numbers::pi / 180;

/// Camera axes (x right, y down, z forward) as columns.
Mat3 axes(const Vec3& forward, const Vec3& up) {
  const Vec3 z = forward.normalized(), right = z.cross(up), x = right.normalized();
  Mat3 rotation;
  rotation << x, z.cross(x), z;
  return rotation;
}
}  // namespace

Camera Camera::make(const LookAtSettings& s, int width, int height) {
  require_valid(s, "camera");
  const Vec3 forward = s.target - s.eye;
  if (!(forward.cross(s.up).norm() > 1e-9 * forward.norm() * s.up.norm()))
    throw InputError("camera: eye and target coincide, or up points along the view; allowed is any other up, such as [0, 1, 0]");
  const Real f = 0.5 * height / std::tan(0.5 * s.fov * kRadians);
  return {width, height, f, f, 0.5 * (width - 1), 0.5 * (height - 1), {axes(forward, s.up), s.eye}};
}

Camera Camera::make(const PinholeSettings& s) { return make(s.calibration, {rotation_exp(s.rotation), s.position}); }

Camera Camera::make(const cosim::Calibration& c, const Pose& X_WC) {
  require_valid(c, "camera");
  return {c.width, c.height, c.fx, c.fy, c.cx, c.cy, X_WC};
}

Vec2 Camera::project(const Vec3& p_W) const {
  const Vec3 p = from_world(p_W);
  return {fx * p.x() / p.z() + cx, fy * p.y() / p.z() + cy};
}

Eigen::Matrix4d Camera::clip_from_world(Real near) const {
  Eigen::Matrix4d clip_from_camera = Eigen::Matrix4d::Zero(), camera_from_world = Eigen::Matrix4d::Identity();
  clip_from_camera(0, 0) = 2 * fx / width;
  clip_from_camera(0, 2) = (2 * cx + 1) / width - 1;  // pixel borders lie at half-integers
  clip_from_camera(1, 1) = -2 * fy / height;
  clip_from_camera(1, 2) = 1 - (2 * cy + 1) / height;
  clip_from_camera(2, 3) = near;
  clip_from_camera(3, 2) = 1;
  camera_from_world.topLeftCorner<3, 3>() = X_WC.rotation.transpose();
  camera_from_world.topRightCorner<3, 1>() = -X_WC.rotation.transpose() * X_WC.position;
  return clip_from_camera * camera_from_world;
}

LookAtSettings overview(const Bounds& bounds, int width, int height) {
  constexpr Real kAzimuth = -55 * kRadians, kElevation = 28 * kRadians, kFill = 0.86;  // share of the picture that is used
  LookAtSettings settings;
  const Real tan_v = std::tan(0.5 * settings.fov * kRadians), tan_h = tan_v * width / height;
  const Vec3 back(std::cos(kElevation) * std::cos(kAzimuth), std::cos(kElevation) * std::sin(kAzimuth), std::sin(kElevation));
  const Mat3 rotation = axes(-back, settings.up);
  settings.target = bounds.center();
  Real distance = 1e-3;
  for (int i = 0; i < 8; ++i) {  // |x| <= (distance + z) tan_h kFill for each corner, and so for y
    const Vec3 p = rotation.transpose() * (bounds.corner(static_cast<Bounds::CornerType>(i)) - settings.target);
    distance = std::max({distance, std::abs(p.x()) / (tan_h * kFill) - p.z(), std::abs(p.y()) / (tan_v * kFill) - p.z()});
  }
  settings.eye = settings.target + distance * back;
  return settings;
}
}  // namespace tape::render
