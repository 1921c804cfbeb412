#pragma once
#include <optional>
#include <string>

#include "tape/core/settings.hpp"
#include "tape/core/types.hpp"

namespace cosim {
using namespace tape;

/// How a lens bends the ideal picture x = (X/Z, Y/Z), with r^2 = |x|^2:
///   x' = x (1 + k1 r^2 + k2 r^4 + k3 r^6) + 2 p1 x y + p2 (r^2 + 2 x^2)
///   y' = y (1 + k1 r^2 + k2 r^4 + k3 r^6) + p1 (r^2 + 2 y^2) + 2 p2 x y.  Source: [Brown 1966]; order and signs are OpenCV's.
struct Distortion {
  Real k1 = 0, k2 = 0, p1 = 0, p2 = 0, k3 = 0;
};
Vec2 distort(const Distortion& lens, const Vec2& x);
/// Slope d distort / d x.
Mat2 distortion_slope(const Distortion& lens, const Vec2& x);
/// Whether the polynomial has turned back between the middle of the picture and x: it is no lens there, and what lies at x is not seen.
bool folds_before(const Distortion& lens, const Vec2& x);
/// The ideal point that the lens bends to y, by Newton's method, which ends when a correction is below 1e-12. Nothing where the lens
/// sends no point: beyond its fold.
std::optional<Vec2> undistort(const Distortion& lens, const Vec2& y);

/// Intrinsics of a camera: a point p_C [m] in its axes (x right, y down, z forward) falls on u = fx x' + cx, v = fy y' + cy, where (x', y')
/// is the distorted (X/Z, Y/Z). The centre of a pixel has integer coordinates.
struct Calibration {
  Real fx = 600, fy = 600;        ///< [px] focal lengths
  Real cx = 423.5, cy = 239.5;    ///< [px] principal point
  int width = 848, height = 480;  ///< [px] of the calibrated picture
  Distortion lens = {};
  template <class F>
  void fields(F&& f) {
    f("fx", fx, "px", Range::positive(), "horizontal focal length");
    f("fy", fy, "px", Range::positive(), "vertical focal length");
    f("cx", cx, "px", Range::any(), "column of the principal point");
    f("cy", cy, "px", Range::any(), "row of the principal point");
    f("width", width, "px", Range::closed(1, 16384), "width of the calibrated picture");
    f("height", height, "px", Range::closed(1, 16384), "height of the calibrated picture");
  }

  Vec2 normalized(const Vec2& pixel) const { return {(pixel.x() - cx) / fx, (pixel.y() - cy) / fy}; }
  Vec2 pixel(const Vec2& x) const { return {fx * x.x() + cx, fy * x.y() + cy}; }
  /// Where a point in camera axes [m] falls in the picture as the lens makes it. Nothing for a point that is not in front of the camera or
  /// lies beyond the fold of the distortion.
  std::optional<Vec2> project(const Vec3& p_C) const;
  /// A pixel of the picture as the lens makes it, in the undistorted picture of the same focal lengths and principal point; to 1e-6 px.
  /// @throws InputError where the lens shows nothing: beyond the fold of the distortion
  Vec2 undistorted(const Vec2& pixel) const;
  Vec2 distorted(const Vec2& pixel) const { return this->pixel(distort(lens, normalized(pixel))); }
  bool holds(const Vec2& pixel) const;  ///< inside the borders of the picture
};

/// @param where  what the calibration was read from; @param picture  what it is to be used for
/// @throws InputError if the picture has another size than the calibration: a scaled or cropped picture has another one
void require_resolution(const Calibration& calibration, int width, int height, const std::string& where, const std::string& picture);
}  // namespace cosim
