#pragma once
#include <filesystem>

namespace cosim {
/// Where settled rolls and convex hulls are kept: $TAPE_CACHE, or `tape` in $XDG_CACHE_HOME, in ~/.cache or in the folder of temporary
/// files.
std::filesystem::path cache_folder();
}  // namespace cosim
