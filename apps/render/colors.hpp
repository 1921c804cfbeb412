#pragma once
#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "tape/core/types.hpp"

namespace tape::render {
/// What the colour of a thing means.
enum class ColorBy { material, strain, tension, contact_force, adhesion, part };
constexpr auto enum_names(ColorBy) {
  return std::array<std::string_view, 6>{"material", "strain", "tension", "contact_force", "adhesion", "part"};
}

/// `sequential`: violet over green to yellow, lightness linear in the value. `diverging`: blue over near white to red, for signed
/// values with a range symmetric about 0.
enum class ColorMap { sequential, diverging };
/// sRGB 0..1 of t in [0, 1]; t beyond is clamped.
Vec3 color(ColorMap map, Real t);

/// What explains colours in the picture: a bar with its two end values, or a list of names.
struct ColorBar {
  std::string title, unit;  ///< unit "" for a pure number
  Real low = 0, high = 1;
  ColorMap map = ColorMap::sequential;
};
struct Swatch {
  std::string name;
  Vec3 color;  ///< sRGB 0..1
};
struct Legend {
  std::optional<ColorBar> bar;
  std::vector<Swatch> swatches;
};

/// One colour per value: color(map, (value - low) / (high - low)); values that are not finite come out grey.
std::vector<Vec3> colors_of(const std::vector<Real>& values, const ColorBar& bar);
/// Bar from the smallest to the largest finite value (symmetric about 0 for `diverging`), so that a caller who knows every frame
/// of a motion can take one range for all. Never empty: where all values agree, the range is widened.
ColorBar bar_over(const std::vector<Real>& values, const std::string& title, const std::string& unit, ColorMap map = ColorMap::sequential);
}  // namespace tape::render
