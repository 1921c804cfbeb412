#pragma once
#include <cstdlib>
#include <filesystem>

namespace robot::test {
/// $TAPE_REAL_DATA, or ../shared/data beside the checkout. Robots and recordings of others, not part of this project: tests skip
/// where they are absent.
inline std::filesystem::path real_data() {
  const char* folder = std::getenv("TAPE_REAL_DATA");
  return folder ? std::filesystem::path(folder) : std::filesystem::path(TAPE_SOURCE_DIR) / ".." / "shared" / "data";
}
inline std::filesystem::path marvin_arm() {
  return real_data() / "marvin_m6_ccs" / "Marvin M6-S-L-CCS-696-V3.1 urdf (FUSION)" / "urdf" / "Marvin M6-S-L-CCS-696-V3.1 urdf.urdf";
}
}  // namespace robot::test
