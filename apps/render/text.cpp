#include "apps/render/text.hpp"

#include <ft2build.h>

#include <cmath>
#include FT_FREETYPE_H

#include "tape/core/error.hpp"

namespace tape::render {
namespace {
/// Takes the next character off UTF-8 text; a broken byte counts as one character.
char32_t next_character(const std::string& text, std::size_t& i) {
  const auto byte = [&](std::size_t k) { return k < text.size() ? static_cast<unsigned char>(text[k]) : 0u; };
  const unsigned first = byte(i++);
  const int more = first >= 0xF0 ? 3 : first >= 0xE0 ? 2 : first >= 0xC0 ? 1 : 0;
  char32_t code = more ? first & (0x3Fu >> more) : first;
  for (int k = 0; k < more && (byte(i) & 0xC0u) == 0x80u; ++k) code = code << 6 | (byte(i++) & 0x3Fu);
  return code;
}
}  // namespace

struct Font::Impl {
  FT_Library library = nullptr;
  FT_Face face = nullptr;
  ~Impl() {
    FT_Done_Face(face);
    FT_Done_FreeType(library);
  }
  /// Calls visit(glyph, x) for each character, x [px] from the start of the line; returns where the line ends.
  template <class Visit>
  int walk(const std::string& text, Visit visit) const {
    long x = 0;  // in 1/64 px
    for (std::size_t i = 0; i < text.size();) {
      if (FT_Load_Char(face, next_character(text, i), FT_LOAD_RENDER)) continue;
      visit(*face->glyph, static_cast<int>(x / 64));
      x += face->glyph->advance.x;
    }
    return static_cast<int>((x + 63) / 64);
  }
};

Font::Font(int size_px) : impl_(std::make_unique<Impl>()) {
  TAPE_CHECK(!FT_Init_FreeType(&impl_->library));
  if (FT_New_Face(impl_->library, TAPE_FONT, 0, &impl_->face))
    throw InputError(std::string(TAPE_FONT) + ": cannot read the font; install the package fonts-dejavu-core");
  TAPE_CHECK(!FT_Set_Pixel_Sizes(impl_->face, 0, static_cast<FT_UInt>(size_px)));
}
Font::~Font() = default;

int Font::line_height() const { return static_cast<int>(impl_->face->size->metrics.height / 64); }

int Font::width(const std::string& text) const {
  return impl_->walk(text, [](const FT_GlyphSlotRec&, int) {});
}

void Font::draw(Picture& picture, int x, int y, const std::string& text, const Vec3& srgb) const {
  const int baseline = y + static_cast<int>(impl_->face->size->metrics.ascender / 64);
  impl_->walk(text, [&](const FT_GlyphSlotRec& glyph, int advance) {
    const FT_Bitmap& map = glyph.bitmap;
    for (int row = 0; row < static_cast<int>(map.rows); ++row)
      for (int column = 0; column < static_cast<int>(map.width); ++column)
        blend(picture, x + advance + glyph.bitmap_left + column, baseline - glyph.bitmap_top + row, srgb,
              map.buffer[row * map.pitch + column] / 255.0);
  });
}

void blend(Picture& picture, int x, int y, const Vec3& srgb, Real opacity) {
  if (x < 0 || y < 0 || x >= picture.width || y >= picture.height) return;
  std::uint8_t* pixel = picture.at(x, y);
  for (int k = 0; k < 3; ++k) pixel[k] = static_cast<std::uint8_t>(std::lround((1 - opacity) * pixel[k] + opacity * 255 * srgb[k]));
}
}  // namespace tape::render
