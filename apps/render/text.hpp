#pragma once
#include <memory>
#include <string>

#include "apps/render/picture.hpp"
#include "tape/core/types.hpp"

namespace tape::render {
/// Draws text (UTF-8) into pictures with DejaVu Sans of the system.
class Font {
 public:
  /// @throws InputError where the font file is missing
  explicit Font(int size_px);
  ~Font();
  int line_height() const;                   ///< [px]
  int width(const std::string& text) const;  ///< [px]
  /// @param x, y  [px] upper left corner of the line; what lies outside the picture is cut off
  void draw(Picture& picture, int x, int y, const std::string& text, const Vec3& srgb) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// picture = (1 - opacity) picture + opacity srgb in the pixel (x, y), if it lies inside.
void blend(Picture& picture, int x, int y, const Vec3& srgb, Real opacity);
}  // namespace tape::render
