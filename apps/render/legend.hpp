#pragma once
#include <string>
#include <vector>

#include "apps/render/colors.hpp"
#include "apps/render/picture.hpp"
#include "apps/render/text.hpp"

namespace tape::render {
/// Draws the legends side by side in the lower left corner and the caption, such as the time, in the upper left one, each on a light panel.
void draw_legends(Picture& picture, const Font& font, const std::vector<Legend>& legends);
void draw_caption(Picture& picture, const Font& font, const std::string& caption);
/// Draws a word that is to be noticed on a red panel in the middle of the upper edge.
void draw_flash(Picture& picture, const Font& font, const std::string& word);
}  // namespace tape::render
