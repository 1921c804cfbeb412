#pragma once
#include <string>
#include <vector>

#include "apps/render/picture.hpp"
#include "apps/render/text.hpp"

namespace tape::render {
/// A quantity over time.
struct Chart {
  std::string name, unit;
  std::vector<Vec2> points;  ///< s, value; in the order of time
  Real from = 0, to = 1;     ///< [s] that is shown
  Real high = 0;             ///< value at its top; 0 is at the bottom
};
/// Draws charts below each other on a panel under the caption, each with its name and last value above.
void draw_charts(Picture& picture, const Font& font, const std::vector<Chart>& charts);
}  // namespace tape::render
