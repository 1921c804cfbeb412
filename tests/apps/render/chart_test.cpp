#include "apps/render/chart.hpp"

#include <gtest/gtest.h>

#include "apps/render/legend.hpp"

using namespace tape;
using namespace tape::render;

namespace {
/// Rows of a column, counted from the top, of pixels that are more blue than red by far: the curve.
std::vector<int> blue_rows(const Picture& picture, int x) {
  std::vector<int> rows;
  for (int y = 0; y < picture.height; ++y)
    if (picture.at(x, y)[2] > picture.at(x, y)[0] + 100) rows.push_back(y);
  return rows;
}
}  // namespace

/// From 0 to 10 over two seconds, and not on: a straight line over the chart's left half.
TEST(Chart, ARampIsAStraightLineUpToItsLastPoint) {
  Picture picture(400, 200);
  std::fill(picture.rgb.begin(), picture.rgb.end(), std::uint8_t{128});
  const Font font(14);
  draw_charts(picture, font, {{.name = "pull", .unit = "N", .points = {{0, 0}, {1, 5}, {2, 10}}, .from = 0, .to = 4, .high = 10}});
  int first = 0, last = picture.width - 1;
  while (blue_rows(picture, first).empty()) ++first;
  while (blue_rows(picture, last).empty()) --last;
  const int bottom = blue_rows(picture, first).front(), top = blue_rows(picture, last).front();
  EXPECT_NEAR(bottom - top, 2 * font.line_height(), 3);
  EXPECT_NEAR(blue_rows(picture, (first + last) / 2).front(), (bottom + top) / 2.0, 1.5);
  EXPECT_NEAR(blue_rows(picture, (3 * first + last) / 4).front(), (3 * bottom + top) / 4.0, 1.5);
  int panel = picture.width - 1;  // right edge of the panel
  while (*picture.at(panel, top) == 128) --panel;
  EXPECT_NEAR(last - first, (panel - first) / 2.0, 8) << "two of four seconds";
}
TEST(Chart, EachStandsBelowTheOther) {
  const Font font(14);
  const auto height = [&](std::size_t charts) {
    Picture picture(400, 400);
    draw_charts(picture, font, std::vector<Chart>(charts, {.name = "pull", .unit = "N", .points = {{0, 1}}, .high = 1}));
    int y = picture.height - 1;
    while (y >= 0 && *picture.at(20, y) == 0) --y;
    return y;
  };
  EXPECT_EQ(height(0), -1);
  EXPECT_GT(height(1), 3 * font.line_height());
  EXPECT_EQ(height(3) - height(2), height(2) - height(1));
}
TEST(Flash, StandsInTheMiddleOfTheUpperEdge) {
  Picture picture(400, 200);
  draw_flash(picture, Font(14), "cut");
  int red = 0;
  for (int y = 0; y < picture.height; ++y)
    for (int x = 0; x < picture.width; ++x) {
      const bool drawn = picture.at(x, y)[0] > 0;
      red += drawn;
      EXPECT_FALSE(drawn && (x < 120 || x > 280 || y > 80)) << x << ", " << y;
    }
  EXPECT_GT(red, 500);
}
