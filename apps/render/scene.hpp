#pragma once
#include <optional>
#include <vector>

#include "apps/render/camera.hpp"
#include "tape/core/types.hpp"

namespace tape::render {
/// Surface to draw. A film is drawn as its middle surface, two-sided.
struct Mesh {
  std::vector<Vec3> vertices{};                    ///< [n] m
  std::vector<Index3> triangles{};                 ///< counter-clockwise seen from the front
  std::vector<Vec3> colors{Vec3(0.7, 0.7, 0.72)};  ///< [1] or [n] sRGB 0..1
  std::optional<Vec3> back_color{};                ///< sRGB 0..1; without it the back looks like the front
  Real crease = 35;   ///< [deg] edges with a sharper angle between normals look sharp; 0: every edge, 180: none
  Real gloss = 0.25;  ///< [1] strength of the highlight, 0..1
};

struct RenderScene {
  std::vector<Mesh> meshes{};
  std::optional<Real>
      ground{};  ///< [m] height z of a ground with lines each 10 and 100 mm (100 mm and 1 m in scenes beyond 2 m); none: no ground
  std::optional<Bounds> bounds{};  ///< of the whole motion, so that shadows do not flicker; by default of the meshes
};

/// Smallest box around all meshes, of no extent in an empty scene.
Bounds bounds_of(const std::vector<Mesh>& meshes);
}  // namespace tape::render
