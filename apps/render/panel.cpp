#include "apps/render/panel.hpp"

namespace tape::render {
void fill(Picture& picture, const Box& box, const Vec3& srgb, Real opacity) {
  for (int y = box.y; y < box.y + box.height; ++y)
    for (int x = box.x; x < box.x + box.width; ++x) blend(picture, x, y, srgb, opacity);
}
}  // namespace tape::render
