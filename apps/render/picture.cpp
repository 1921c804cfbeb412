#include "apps/render/picture.hpp"

#include <png.h>

#include "tape/core/error.hpp"

namespace tape::render {
void write_png(const std::filesystem::path& path, const Picture& picture) {
  const std::filesystem::path part = path.string() + ".part";
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  image.width = static_cast<png_uint_32>(picture.width);
  image.height = static_cast<png_uint_32>(picture.height);
  image.format = PNG_FORMAT_RGB;
  image.flags = PNG_IMAGE_FLAG_FAST;
  std::error_code failure;
  if (!png_image_write_to_file(&image, part.c_str(), 0, picture.rgb.data(), 0, nullptr)) {
    std::filesystem::remove(part, failure);
    throw InputError(path.string() + ": cannot write the picture: " + image.message);
  }
  std::filesystem::rename(part, path, failure);
  if (failure) throw InputError(path.string() + ": cannot write the picture: " + failure.message());
}
}  // namespace tape::render
