#pragma once
#include <memory>

#include "apps/render/camera.hpp"
#include "apps/render/picture.hpp"
#include "apps/render/scene.hpp"

namespace tape::render {
/// Draws scenes without a display: OSMesa, OpenGL 4.5 core. Key light with a filtered shadow map, fill light, light from the sky,
/// four samples per pixel. Equal input gives equal pictures on one machine, for any number of threads.
/// Holds one OpenGL context (40 ms to set up), so keep it for a whole video. Not for several threads at once.
class Renderer {
 public:
  /// @param width, height  [px]  @throws InputError where OSMesa refuses the size or the context
  Renderer(int width, int height);
  ~Renderer();
  Renderer(Renderer&&) noexcept;
  Renderer& operator=(Renderer&&) noexcept;
  /// @throws InputError where the aspect ratio of the camera is not that of the picture
  Picture draw(const RenderScene& scene, const Camera& camera);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};
}  // namespace tape::render
