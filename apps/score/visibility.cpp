#include "apps/score/visibility.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <numbers>

namespace tape::score {
namespace {
constexpr Real kThin = 2;  // [px] width of an ellipse that nobody can mark
constexpr int kPoints = 72;

/// Whether a triangle meets the segment from a to b.  Source: Moeller and Trumbore's test.
bool meets(const Vec3& a, const Vec3& b, const Vec3& t0, const Vec3& t1, const Vec3& t2) {
  const Vec3 along = b - a, e1 = t1 - t0, e2 = t2 - t0, normal = along.cross(e2);
  const Real det = e1.dot(normal);
  if (det == 0) return false;
  const Vec3 from = a - t0, across = from.cross(e1);
  const Real u = from.dot(normal) / det, v = along.dot(across) / det, s = e2.dot(across) / det;
  return u >= 0 && v >= 0 && u + v <= 1 && s > 0 && s < 1;
}

std::vector<Vec3> circle(const Hub& hub, Real height) {
  std::vector<Vec3> points;
  for (int i = 0; i < kPoints; ++i) {
    const Real angle = 2 * std::numbers::pi * i / kPoints;
    points.push_back(apply(hub.X_WH, {hub.inner_radius * std::cos(angle), hub.inner_radius * std::sin(angle), height}));
  }
  return points;
}

/// Width [px] of the ellipse on which points of a circle fall: those at equal angles scatter by half the squares of its half axes.
Real width(const render::Camera& camera, const std::vector<Vec3>& points) {
  Vec2 mean = Vec2::Zero();
  Mat2 scatter = Mat2::Zero();
  const Real n = static_cast<Real>(points.size());
  for (const Vec3& p : points) mean += camera.project(p) / n;
  for (const Vec3& p : points) {
    const Vec2 off = camera.project(p) - mean;
    scatter += off * off.transpose() / n;
  }
  return 2 * std::sqrt(2 * std::max(0.0, Eigen::SelfAdjointEigenSolver<Mat2>(scatter).eigenvalues()[0]));
}

/// Those of the triangles whose boxes meet the one around a camera and the points that it looks at.
std::vector<Index3> between(const std::vector<Vec3>& x, const std::vector<Index3>& triangles, const Eigen::AlignedBox<Real, 3>& box) {
  std::vector<Index3> near;
  for (const Index3& t : triangles) {
    Eigen::AlignedBox<Real, 3> own;
    for (int v : t) own.extend(x[static_cast<std::size_t>(v)]);
    if (box.intersects(own)) near.push_back(t);
  }
  return near;
}
}  // namespace

Sight sight_of(const render::Camera& camera, const Hub& hub, const Obstacles& obstacles) {
  using cosim::LandmarkKind;
  const int end = facing_end(camera, hub);
  std::vector<Vec3> points = circle(hub, 0.5 * (end == 0 ? 1 : end) * hub.height);
  const auto in_front = [&](const Vec3& p) { return camera.from_world(p).z() > 0; };
  if (!std::ranges::all_of(points, in_front)) return {};
  Sight sight{.kind = end != 0 && width(camera, points) >= kThin ? LandmarkKind::rim : LandmarkKind::side_box};
  if (sight.kind == LandmarkKind::side_box)
    for (const Vec3& p : circle(hub, -0.5 * (end == 0 ? 1 : end) * hub.height)) points.push_back(p);
  Eigen::AlignedBox<Real, 3> box(camera.X_WC.position);
  for (const Vec3& p : points) box.extend(p);
  std::vector<Index3> before = between(obstacles.x, obstacles.bodies, box);
  if (sight.kind == LandmarkKind::rim)
    for (const Index3& t : between(obstacles.x, obstacles.tapes, box)) before.push_back(t);
  const auto& x = obstacles.x;
  const auto seen = [&](const Vec3& p) {
    const Vec2 pixel = camera.project(p);
    if (!in_front(p) || pixel.x() < -0.5 || pixel.y() < -0.5 || pixel.x() > camera.width - 0.5 || pixel.y() > camera.height - 0.5)
      return false;
    return std::ranges::none_of(before, [&](const Index3& t) {
      return meets(camera.X_WC.position, p, x[static_cast<std::size_t>(t[0])], x[static_cast<std::size_t>(t[1])],
                   x[static_cast<std::size_t>(t[2])]);
    });
  };
  sight.share = static_cast<Real>(std::ranges::count_if(points, seen)) / static_cast<Real>(points.size());
  return sight;
}
}  // namespace tape::score
