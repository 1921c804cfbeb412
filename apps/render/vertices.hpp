#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "apps/render/scene.hpp"

namespace tape::render {
/// Corner of a triangle as the shaders read it.
struct DrawVertex {
  std::array<float, 3> position, normal;  // [m], [1]
  std::array<std::uint8_t, 4> front;      // sRGB; fourth: gloss
  std::array<std::uint8_t, 4> back;       // sRGB
};

/// Three corners per triangle. The normal of a corner is the area-weighted sum over the triangles at its vertex that lie within
/// the crease angle of its own triangle.
/// @param origin  [m] subtracted from positions, so that single precision suffices
/// @throws InputError for a number of colours that is neither 1 nor that of the vertices
std::vector<DrawVertex> corners_of(const std::vector<Mesh>& meshes, const Vec3& origin);
}  // namespace tape::render
