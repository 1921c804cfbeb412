#pragma once
#include "apps/render/picture.hpp"
#include "apps/render/text.hpp"

namespace tape::render {
inline const Vec3 kInk(0.13, 0.14, 0.16), kPaper(1, 1, 1);  // sRGB of text, and of the panels under it
constexpr Real kPaperOpacity = 0.78;

struct Box {
  int x, y, width, height;  ///< [px]
};
/// Mixes a colour into a box; what lies outside the picture is left out.
void fill(Picture& picture, const Box& box, const Vec3& srgb, Real opacity);

/// [px] of the panel of a caption, which stands half a line below the upper edge.
inline int caption_height(const Font& font) { return font.line_height() + font.line_height() / 2; }
}  // namespace tape::render
