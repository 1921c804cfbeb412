#pragma once
#include <string>

#include "cosim/scene/reader.hpp"

namespace cosim {
/// Refuses, at its place, a name that names no folder of its own.
inline void require_folder_name(const Reader& where, const std::string& name) {
  if (name.empty() || name.find('/') != std::string::npos || name == "." || name == "..")
    where.fail("names a folder of results: it is not empty, holds no slash and is neither . nor ..");
}
}  // namespace cosim
