#include "apps/score/landmark.hpp"

#include <cmath>
#include <numbers>

namespace tape::score {
namespace {
/// Camera along the hub's axis [m], from its middle.
Real height_of(const render::Camera& camera, const Hub& hub) {
  return hub.X_WH.rotation.col(2).dot(camera.X_WC.position - hub.X_WH.position);
}
/// Middle of the inner rim that faces the camera, or is nearer to it.
Vec3 rim_centre(const render::Camera& camera, const Hub& hub) {
  const Real side = height_of(camera, hub) < 0 ? -1 : 1;
  return apply(hub.X_WH, {0, 0, 0.5 * side * hub.height});
}
}  // namespace

std::optional<Vec2> circle_centre(const render::Camera& camera, const Vec3& p_WC, const Vec3& n_W, Real radius) {
  const Vec3 C = camera.from_world(p_WC), n = camera.X_WC.rotation.transpose() * n_W;
  const Real r2 = radius * radius;
  const Vec3 pole = C.z() * C + r2 * n.z() * n - r2 * Vec3::UnitZ();  // -D (0, 0, 1) before K
  if (!(C.z() > 0 && pole.z() > 0)) return std::nullopt;              // pole.z = C_z^2 - r^2 (1 - n_z^2): the nearest point has z > 0
  return Vec2(camera.fx * pole.x() / pole.z() + camera.cx, camera.fy * pole.y() / pole.z() + camera.cy);
}

int facing_end(const render::Camera& camera, const Hub& hub) {
  const Real height = height_of(camera, hub);
  if (std::abs(height) <= 0.5 * hub.height) return 0;
  return height > 0 ? 1 : -1;
}

std::optional<Vec2> hub_landmark(const render::Camera& camera, const Hub& hub, cosim::LandmarkKind kind) {
  if (kind == cosim::LandmarkKind::rim) return circle_centre(camera, rim_centre(camera, hub), hub.X_WH.rotation.col(2), hub.inner_radius);
  if (!(camera.from_world(hub.X_WH.position).z() > 0)) return std::nullopt;
  return camera.project(hub.X_WH.position);
}

std::vector<Vec2> rim_outline(const render::Camera& camera, const Hub& hub, int points) {
  const Vec3 centre = rim_centre(camera, hub);
  std::vector<Vec2> outline;
  for (int i = 0; i < points; ++i) {
    const Real angle = 2 * std::numbers::pi * i / points;
    const Vec3 p = centre + hub.inner_radius * hub.X_WH.rotation * Vec3(std::cos(angle), std::sin(angle), 0);
    if (!(camera.from_world(p).z() > 0)) return {};
    outline.push_back(camera.project(p));
  }
  return outline;
}
}  // namespace tape::score
