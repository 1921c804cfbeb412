#include "cosim/episode/calibration.hpp"

#include <fmt/format.h>

#include <Eigen/LU>

namespace cosim {
namespace {
constexpr Real kEnough = 1e-12;  // [1] of a Newton correction: 1e-8 px for the longest lens

/// Newton's method for distort(x) = y from a start nearby.
std::optional<Vec2> newton(const Distortion& lens, const Vec2& y, Vec2 x) {
  constexpr int kMost = 50;
  for (int i = 0; i < kMost; ++i) {
    const Mat2 slope = distortion_slope(lens, x);
    if (!(slope.determinant() > 0)) return std::nullopt;
    const Vec2 correction = slope.inverse() * (distort(lens, x) - y);
    x -= correction;
    if (!(x.norm() < 1e3)) return std::nullopt;
    if (correction.norm() <= kEnough * (1 + x.norm())) return x;
  }
  return std::nullopt;
}
}  // namespace

Vec2 distort(const Distortion& d, const Vec2& p) {
  const Real x = p.x(), y = p.y(), r2 = p.squaredNorm(), radial = 1 + r2 * (d.k1 + r2 * (d.k2 + r2 * d.k3));
  return {x * radial + 2 * d.p1 * x * y + d.p2 * (r2 + 2 * x * x), y * radial + d.p1 * (r2 + 2 * y * y) + 2 * d.p2 * x * y};
}

Mat2 distortion_slope(const Distortion& d, const Vec2& p) {
  const Real x = p.x(), y = p.y(), r2 = p.squaredNorm();
  const Real radial = 1 + r2 * (d.k1 + r2 * (d.k2 + r2 * d.k3)), slope = 2 * (d.k1 + r2 * (2 * d.k2 + r2 * 3 * d.k3));
  const Real mixed = slope * x * y + 2 * d.p1 * x + 2 * d.p2 * y;
  Mat2 m;
  m << radial + slope * x * x + 2 * d.p1 * y + 6 * d.p2 * x, mixed,  //
      mixed, radial + slope * y * y + 6 * d.p1 * y + 2 * d.p2 * x;
  return m;
}

bool folds_before(const Distortion& lens, const Vec2& x) {
  constexpr int kSamples = 64;
  for (int i = 1; i <= kSamples; ++i)
    if (!(distortion_slope(lens, static_cast<Real>(i) / kSamples * x).determinant() > 0)) return true;
  return false;
}

std::optional<Vec2> undistort(const Distortion& lens, const Vec2& y) {
  if (!y.allFinite()) return std::nullopt;
  for (int steps : {1, 8, 64}) {  // a strong lens is followed from the middle of the picture outwards
    std::optional<Vec2> x = steps == 1 ? y : Vec2(Vec2::Zero());
    for (int k = 1; k <= steps && x; ++k) x = newton(lens, static_cast<Real>(k) / steps * y, *x);
    if (x && !folds_before(lens, *x)) return x;
  }
  return std::nullopt;
}

std::optional<Vec2> Calibration::project(const Vec3& p_C) const {
  if (!(p_C.z() > 0)) return std::nullopt;
  const Vec2 x = p_C.head<2>() / p_C.z();
  if (folds_before(lens, x)) return std::nullopt;
  return pixel(distort(lens, x));
}

Vec2 Calibration::undistorted(const Vec2& at) const {
  const std::optional<Vec2> x = undistort(lens, normalized(at));
  if (!x)
    throw InputError(
        fmt::format("pixel ({:g}, {:g}) cannot be undistorted: the distortion of this calibration folds over before it", at.x(), at.y()));
  return pixel(*x);
}

bool Calibration::holds(const Vec2& at) const {
  return at.x() >= -0.5 && at.x() <= width - 0.5 && at.y() >= -0.5 && at.y() <= height - 0.5;
}

void require_resolution(const Calibration& calibration, int width, int height, const std::string& where, const std::string& picture) {
  if (calibration.width != width || calibration.height != height)
    throw InputError(fmt::format("{}: is a calibration for pictures of {} x {} px, {} has {} x {} px (allowed: the same)", where,
                                 calibration.width, calibration.height, picture, width, height));
}
}  // namespace cosim
