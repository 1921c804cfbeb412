#pragma once
#include <optional>
#include <vector>

#include "apps/render/camera.hpp"
#include "cosim/episode/episode.hpp"

namespace tape::score {
/// A ring with its middle in the origin of its frame and its axis along z.
struct Hub {
  Pose X_WH;
  Real inner_radius = 0.019;  ///< [m]
  Real height = 0.020;        ///< [m] along the axis
};

/// Centre [px] of the ellipse in which a pinhole camera sees a circle of centre C, unit normal n and radius r, all in camera axes. With the
/// dual conic of the circle,
///   D = K [r^2 (I - n n^T) - C C^T] K^T,
/// it is the pole of the line at infinity, (D_13, D_23) / D_33. Neither the projected centre of the circle nor the mean of points on it
/// lies there.  Source: [Hartley 2004, ch. 2 and 8].
/// Nothing unless the whole circle is in front of the camera: its image is no ellipse then. A circle seen edge-on is a line segment, and
/// this its middle.
std::optional<Vec2> circle_centre(const render::Camera& camera, const Vec3& p_WC, const Vec3& n_W, Real radius);

/// Which end of the hub the camera sees: 1 the end at +z, -1 that at -z, 0 neither: the camera stands between the planes of its ends, so
/// that the wall hides the bore.
int facing_end(const render::Camera& camera, const Hub& hub);

/// Where a landmark of this kind of a simulated hub lies in the undistorted picture. Nothing if it is not in front of the camera.
///  - rim: circle_centre of the inner rim at the end that faces the camera; of the nearer end where neither does;
///  - side_box: the projected middle of the hub's axis-aligned bounding box in space. A ring is its own mirror image through its middle,
///  and
///    so is any such box of it: the middle of the box is the hub's, whatever the axes.
std::optional<Vec2> hub_landmark(const render::Camera& camera, const Hub& hub, cosim::LandmarkKind kind);

/// Points [px] of that inner rim, for drawing; empty unless all of it is in front of the camera.
std::vector<Vec2> rim_outline(const render::Camera& camera, const Hub& hub, int points = 72);
}  // namespace tape::score
