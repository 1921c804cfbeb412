#pragma once
#include <filesystem>

#include "cosim/scene/reader.hpp"
#include "tape/model/triangle_mesh.hpp"

namespace cosim {
/// Mesh of a body from its `shape` and the keys that go with it. Not checked yet.
/// @param scene_file  mesh files are looked for from its folder on
tape::TriangleMesh read_shape(const Reader& body, const std::filesystem::path& scene_file);
}  // namespace cosim
