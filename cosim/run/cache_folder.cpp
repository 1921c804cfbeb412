#include "cosim/run/cache_folder.hpp"

#include <cstdlib>

namespace cosim {
std::filesystem::path cache_folder() {
  const auto variable = [](const char* name) {
    const char* value = std::getenv(name);
    return std::filesystem::path(value ? value : "");
  };
  if (auto folder = variable("TAPE_CACHE"); !folder.empty()) return folder;
  if (auto folder = variable("XDG_CACHE_HOME"); !folder.empty()) return folder / "tape";
  if (auto folder = variable("HOME"); !folder.empty()) return folder / ".cache" / "tape";
  return std::filesystem::temp_directory_path() / "tape";
}
}  // namespace cosim
