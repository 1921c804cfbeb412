#include "apps/render/legend.hpp"

#include <algorithm>
#include <cstdio>

#include "apps/render/panel.hpp"

namespace tape::render {
namespace {
const Vec3 kAlarm(0.80, 0.10, 0.14);

std::string number(Real value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.3g", value == 0 ? 0 : value);  // no "-0"
  return text;
}
std::string title_of(const ColorBar& bar) { return bar.title + (bar.unit.empty() ? "" : " [" + bar.unit + "]"); }

int bar_width(const Font& font, const ColorBar& bar) {
  const int ends = font.width(number(bar.low)) + font.width(number(bar.high)) + 2 * font.line_height();
  return std::max({12 * font.line_height(), font.width(title_of(bar)), ends});
}

int width_of(const Legend& legend, const Font& font) {
  int width = legend.bar ? bar_width(font, *legend.bar) : 0;
  for (const Swatch& s : legend.swatches) width = std::max(width, font.width(s.name) + 3 * font.line_height() / 2);
  return width;
}
int height_of(const Legend& legend, const Font& font) {
  return font.line_height() * ((legend.bar ? 3 : 0) + static_cast<int>(legend.swatches.size()));
}

/// Title, bar and end values, a line each.
void draw_bar(Picture& picture, const Font& font, const ColorBar& bar, int left, int top) {
  const int line = font.line_height(), width = bar_width(font, bar);
  font.draw(picture, left, top, title_of(bar), kInk);
  for (int x = 0; x < width; ++x) fill(picture, {left + x, top + line + line / 8, 1, 3 * line / 4}, color(bar.map, x / (width - 1.0)), 1);
  font.draw(picture, left, top + 2 * line, number(bar.low), kInk);
  font.draw(picture, left + width - font.width(number(bar.high)), top + 2 * line, number(bar.high), kInk);
}

void draw_swatches(Picture& picture, const Font& font, const std::vector<Swatch>& swatches, int left, int top) {
  const int line = font.line_height();
  for (const Swatch& s : swatches) {
    fill(picture, {left, top + line / 6, line, 2 * line / 3}, s.color, 1);
    font.draw(picture, left + 3 * line / 2, top, s.name, kInk);
    top += line;
  }
}
}  // namespace

void draw_legends(Picture& picture, const Font& font, const std::vector<Legend>& legends) {
  const int pad = font.line_height() / 2;
  int left = pad;
  for (const Legend& legend : legends) {
    const int width = width_of(legend, font), height = height_of(legend, font);
    if (height == 0) continue;
    const Box panel{left, picture.height - height - 3 * pad, width + 2 * pad, height + 2 * pad};
    fill(picture, panel, kPaper, kPaperOpacity);
    if (legend.bar) draw_bar(picture, font, *legend.bar, panel.x + pad, panel.y + pad);
    draw_swatches(picture, font, legend.swatches, panel.x + pad, panel.y + pad + (legend.bar ? 3 * font.line_height() : 0));
    left += panel.width + pad;
  }
}

void draw_caption(Picture& picture, const Font& font, const std::string& caption) {
  if (caption.empty()) return;
  const int pad = font.line_height() / 2;
  fill(picture, {pad, pad, font.width(caption) + 2 * pad, caption_height(font)}, kPaper, kPaperOpacity);
  font.draw(picture, 2 * pad, pad + pad / 2, caption, kInk);
}

void draw_flash(Picture& picture, const Font& font, const std::string& word) {
  const int pad = font.line_height() / 2, width = font.width(word) + 4 * pad, left = (picture.width - width) / 2;
  fill(picture, {left, pad, width, caption_height(font)}, kAlarm, 1);
  font.draw(picture, left + 2 * pad, pad + pad / 2, word, kPaper);
}
}  // namespace tape::render
