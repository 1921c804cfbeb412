#include "apps/render/picture.hpp"

#include <png.h>

#include <string>

#include "cosim/run/new_file.hpp"
#include "tape/core/error.hpp"

namespace tape::render {
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
