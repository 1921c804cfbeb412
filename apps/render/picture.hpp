#pragma once
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <vector>

namespace tape::render {
/// 8-bit sRGB picture, rows from top to bottom, no padding.
struct Picture {
  int width = 0, height = 0;      ///< [px]
  std::vector<std::uint8_t> rgb;  ///< 3 width height
  Picture() = default;
  Picture(int w, int h) : width(w), height(h), rgb(3 * static_cast<std::size_t>(w) * static_cast<std::size_t>(h)) {}
  /// The three bytes of the pixel in column x of row y.
  std::uint8_t* at(int x, int y) {
    return rgb.data() + 3 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x));
  }
  const std::uint8_t* at(int x, int y) const { return const_cast<Picture*>(this)->at(x, y); }
};

/// Puts a picture over a part of another, its upper left corner at (x, y); what lies outside is cut off.
void paste(Picture& onto, const Picture& part, int x, int y);
/// Pictures of equal height, from left to right.
Picture side_by_side(const std::vector<Picture>& pictures);

/// Writes under a temporary name and renames.  @throws InputError naming the file and the reason
void write_png(const std::filesystem::path& path, const Picture& picture);
}  // namespace tape::render
