#include "apps/render/colors.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "apps/render/legend.hpp"
using namespace tape;
using namespace tape::render;

namespace {
/// CIE luminance of an sRGB colour, 0..1 (IEC 61966-2-1).
Real luminance(const Vec3& srgb) {
  const auto linear = [](Real c) { return c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4); };
  return 0.2126 * linear(srgb.x()) + 0.7152 * linear(srgb.y()) + 0.0722 * linear(srgb.z());
}
Real lightness(const Vec3& srgb) { return 116 * std::cbrt(luminance(srgb)) - 16; }  // CIE L*, above 8
constexpr Real kNaN = std::numeric_limits<Real>::quiet_NaN(), kInfinity = std::numeric_limits<Real>::infinity();
}  // namespace

TEST(Colors, TheSequentialMapGetsLighterInEqualSteps) {
  const Real whole = lightness(color(ColorMap::sequential, 1)) - lightness(color(ColorMap::sequential, 0));
  EXPECT_GT(whole, 65);
  for (int i = 0; i < 20; ++i) {
    const Real step = lightness(color(ColorMap::sequential, (i + 1) / 20.0)) - lightness(color(ColorMap::sequential, i / 20.0));
    EXPECT_NEAR(step, whole / 20, 0.25 * whole / 20) << "step " << i;
  }
}

TEST(Colors, NoChannelOfAMapLeavesTheDisplay) {
  for (ColorMap map : {ColorMap::sequential, ColorMap::diverging})
    for (int i = 0; i <= 100; ++i) {
      const Vec3 c = color(map, i / 100.0);
      EXPECT_GE(c.minCoeff(), 0);
      EXPECT_LE(c.maxCoeff(), 1);
    }
}

TEST(Colors, TheDivergingMapIsBlueBelowRedAboveAndLightestInTheMiddle) {
  const Vec3 low = color(ColorMap::diverging, 0), high = color(ColorMap::diverging, 1);
  EXPECT_GT(low.z(), low.x() + 0.4);
  EXPECT_GT(high.x(), high.z() + 0.4);
  EXPECT_NEAR(lightness(low), lightness(high), 8);
  for (Real t : {0.3, 0.45, 0.55, 0.7}) EXPECT_LT(lightness(color(ColorMap::diverging, t)), lightness(color(ColorMap::diverging, 0.5)));
}

TEST(Colors, ScalarsAreMappedOverTheRangeOfTheBarAndWhatIsNotFiniteIsGrey) {
  const ColorBar bar{"force", "N", 2, 6, ColorMap::sequential};
  const std::vector<Vec3> colors = colors_of({2, 5, 100, kNaN, kInfinity}, bar);
  EXPECT_EQ(colors[0], color(ColorMap::sequential, 0));
  EXPECT_EQ(colors[1], color(ColorMap::sequential, 0.75));
  EXPECT_EQ(colors[2], color(ColorMap::sequential, 1));
  for (std::size_t i : {3, 4}) EXPECT_EQ(colors[i].minCoeff(), colors[i].maxCoeff());
}

TEST(Colors, ABarSpansTheFiniteValues) {
  const ColorBar bar = bar_over({3, kNaN, -1, 2, kInfinity}, "strain", "%");
  EXPECT_EQ(bar.low, -1);
  EXPECT_EQ(bar.high, 3);
  const ColorBar symmetric = bar_over({3, -5, 1}, "strain", "%", ColorMap::diverging);
  EXPECT_EQ(symmetric.low, -5);
  EXPECT_EQ(symmetric.high, 5);
  for (const std::vector<Real>& same : {std::vector<Real>{}, {0, 0}, {7}, {kNaN}})
    for (ColorMap map : {ColorMap::sequential, ColorMap::diverging}) {
      const ColorBar widened = bar_over(same, "strain", "%", map);
      EXPECT_LT(widened.low, widened.high);
    }
}

TEST(Legend, ShowsBothEndsOfTheBarEachSwatchAndText) {
  Picture picture(400, 200);
  const Vec3 kGreen(0, 1, 0);
  const ColorBar bar{"strain", "%", -1, 1, ColorMap::diverging};
  draw_legends(picture, Font(14), {{bar, {}}, {{}, {{"grass", kGreen}}}});
  const auto count = [&](const Vec3& srgb) {
    int n = 0;
    for (int y = 0; y < picture.height; ++y)
      for (int x = 0; x < picture.width; ++x) {
        const std::uint8_t* p = picture.at(x, y);
        n += std::lround(255 * srgb.x()) == p[0] && std::lround(255 * srgb.y()) == p[1] && std::lround(255 * srgb.z()) == p[2];
      }
    return n;
  };
  EXPECT_GT(count(color(bar.map, 0)), 5);
  EXPECT_GT(count(color(bar.map, 1)), 5);
  EXPECT_GT(count(kGreen), 50);
  const Font font(14);
  EXPECT_GT(font.width("strain [%]"), font.width("strain"));
  EXPECT_EQ(font.width("µ²"), font.width("µ") + font.width("²")) << "two characters of two bytes each";
}

TEST(Legend, ACaptionIsDarkTextOnALightPanel) {
  Picture picture(400, 200);
  std::fill(picture.rgb.begin(), picture.rgb.end(), std::uint8_t{128});
  draw_caption(picture, Font(14), "t = 1.25 s");
  const auto [darkest, lightest] = std::minmax_element(picture.rgb.begin(), picture.rgb.end());
  EXPECT_LT(*darkest, 60);
  EXPECT_GT(*lightest, 220);
  EXPECT_EQ(*picture.at(300, 150), 128);
}
