#pragma once
#include <filesystem>

#include "cosim/scene/reader.hpp"
#include "tape/model/scene.hpp"

namespace cosim {
/// A body from its section, but for its material. Its mesh is checked.
tape::Body read_body(const Reader& section, const std::string& name, const std::filesystem::path& scene_file);
}  // namespace cosim
