#include "apps/render/picture.hpp"

#include <png.h>

#include <algorithm>
#include <string>

#include "cosim/run/new_file.hpp"
#include "tape/core/error.hpp"

namespace tape::render {
void paste(Picture& onto, const Picture& part, int x, int y) {
  const int left = std::max(0, -x), right = std::min(part.width, onto.width - x);
  for (int row = std::max(0, -y); row < std::min(part.height, onto.height - y) && left < right; ++row)
    std::copy_n(part.at(left, row), 3 * (right - left), onto.at(x + left, y + row));
}

Picture side_by_side(const std::vector<Picture>& pictures) {
  int width = 0;
  for (const Picture& picture : pictures) width += picture.width;
  Picture joined(width, pictures.empty() ? 0 : pictures[0].height);
  int left = 0;
  for (const Picture& picture : pictures) {
    paste(joined, picture, left, 0);
    left += picture.width;
  }
  return joined;
}

void write_png(const std::filesystem::path& path, const Picture& picture) {
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  image.width = static_cast<png_uint_32>(picture.width);
  image.height = static_cast<png_uint_32>(picture.height);
  image.format = PNG_FORMAT_RGB;
  image.flags = PNG_IMAGE_FLAG_FAST;
  png_alloc_size_t size = PNG_IMAGE_PNG_SIZE_MAX(image);
  std::string bytes(size, '\0');
  if (!png_image_write_to_memory(&image, bytes.data(), &size, 0, picture.rgb.data(), 0, nullptr))
    throw InputError(path.string() + ": cannot write the picture: " + image.message);
  cosim::write_text(path, std::string_view(bytes).substr(0, size));
}
}  // namespace tape::render
