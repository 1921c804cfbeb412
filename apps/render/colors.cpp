#include "apps/render/colors.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace tape::render {
namespace {
const Vec3 kNoValue(0.55, 0.55, 0.55);

Real to_srgb(Real linear) {
  const Real c = std::clamp(linear, 0.0, 1.0);
  return c <= 0.0031308 ? 12.92 * c : 1.055 * std::pow(c, 1 / 2.4) - 0.055;
}

/// sRGB of lightness L, chroma C, hue h [rad] in OKLab.  Source: [Ottosson 2020], OKLab.
Vec3 from_oklch(Real lightness, Real chroma, Real hue) {
  const Real a = chroma * std::cos(hue), b = chroma * std::sin(hue);
  const Real l = std::pow(lightness + 0.3963377774 * a + 0.2158037573 * b, 3);
  const Real m = std::pow(lightness - 0.1055613458 * a - 0.0638541728 * b, 3);
  const Real s = std::pow(lightness - 0.0894841775 * a - 1.2914855480 * b, 3);
  return {to_srgb(4.0767416621 * l - 3.3077115913 * m + 0.2309699292 * s), to_srgb(-1.2684380046 * l + 2.6097574011 * m - 0.3413193965 * s),
          to_srgb(-0.0041960863 * l - 0.7034186147 * m + 1.7076147010 * s)};
}
}  // namespace

Vec3 color(ColorMap map, Real t) {
  constexpr Real kDegree = std::numbers::pi / 180;
  t = std::clamp(t, 0.0, 1.0);
  if (map == ColorMap::sequential) return from_oklch(0.27 + 0.65 * t, 0.095 + 0.075 * t * t * t * t, (310 - 205 * t) * kDegree);
  const Real side = 2 * t - 1, distance = std::abs(side);
  return from_oklch(0.96 - 0.48 * distance, 0.20 * distance, (side < 0 ? 258 : 27) * kDegree);
}

std::vector<Vec3> colors_of(const std::vector<Real>& values, const ColorBar& bar) {
  std::vector<Vec3> colors;
  colors.reserve(values.size());
  for (Real v : values) colors.push_back(std::isfinite(v) ? color(bar.map, (v - bar.low) / (bar.high - bar.low)) : kNoValue);
  return colors;
}

ColorBar bar_over(const std::vector<Real>& values, const std::string& title, const std::string& unit, ColorMap map) {
  Real low = std::numeric_limits<Real>::infinity(), high = -low;
  for (Real v : values)
    if (std::isfinite(v)) low = std::min(low, v), high = std::max(high, v);
  if (low > high) low = 0, high = 0;
  if (map == ColorMap::diverging) high = std::max(std::abs(low), std::abs(high)), low = -high;
  if (!(high > low)) high = low + std::max(std::abs(low), 1.0) * 1e-3, low -= high - low;
  return {title, unit, low, high, map};
}
}  // namespace tape::render
