#include "apps/render/chart.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <optional>

#include "apps/render/panel.hpp"

namespace tape::render {
namespace {
const Vec3 kLine(0.12, 0.35, 0.62);
constexpr Real kShade = 0.18;  // opacity under the line

/// The last value, and the one at the top, to three digits of that: "2.31 N, max 4.00 N".
std::string figures(const Chart& chart) {
  char text[96];
  const char* unit = chart.unit.c_str();
  const Real last = chart.points.empty() ? 0 : chart.points.back().y();
  const int before = chart.high > 0 ? static_cast<int>(std::floor(std::log10(chart.high))) : 0, decimals = std::clamp(2 - before, 0, 6);
  std::snprintf(text, sizeof text, "%.*f %s, max %.*f %s", decimals, last, unit, decimals, chart.high, unit);
  return text;
}

/// Between its points; nothing before the first and after the last.
std::optional<Real> value_at(const std::vector<Vec2>& points, Real t) {
  const auto after = std::ranges::lower_bound(points, t, {}, [](const Vec2& p) { return p.x(); });
  if (after == points.end()) return {};
  if (after->x() == t) return after->y();
  if (after == points.begin()) return {};
  const Vec2 &a = *(after - 1), &b = *after;
  return a.y() + (t - a.x()) / (b.x() - a.x()) * (b.y() - a.y());
}

void draw_curve(Picture& picture, const Chart& chart, const Box& box) {
  const int bottom = box.y + box.height;
  const Real scale = chart.high > 0 ? (box.height - 1) / chart.high : 0;
  std::optional<int> last;
  for (int c = 0; c < box.width; ++c) {
    const std::optional<Real> value = value_at(chart.points, chart.from + (chart.to - chart.from) * c / (box.width - 1));
    if (!value || !std::isfinite(*value)) continue;
    const int top = bottom - 1 - static_cast<int>(std::lround(std::clamp(*value * scale, 0.0, box.height - 1.0)));
    const int low = std::min(top, last.value_or(top)), high = std::max(top, last.value_or(top));
    fill(picture, {box.x + c, top, 1, bottom - top}, kLine, kShade);
    fill(picture, {box.x + c, low, 1, std::max(2, high - low)}, kLine, 1);
    last = top;
  }
  fill(picture, {box.x, bottom, box.width, 1}, kInk, 1);
}
}  // namespace

void draw_charts(Picture& picture, const Font& font, const std::vector<Chart>& charts) {
  if (charts.empty()) return;
  const int line = font.line_height(), pad = line / 2, height = 2 * line, each = line + height + pad;
  int width = 12 * line;
  for (const Chart& chart : charts) width = std::max(width, font.width(chart.name) + font.width(figures(chart)) + line);
  const Box panel{pad, caption_height(font) + 2 * pad, width + 2 * pad, static_cast<int>(charts.size()) * each + pad};
  fill(picture, panel, kPaper, kPaperOpacity);
  int top = panel.y + pad / 2;
  for (const Chart& chart : charts) {
    const std::string text = figures(chart);
    font.draw(picture, panel.x + pad, top, chart.name, kInk);
    font.draw(picture, panel.x + pad + width - font.width(text), top, text, kInk);
    draw_curve(picture, chart, {panel.x + pad, top + line, width, height});
    top += each;
  }
}
}  // namespace tape::render
