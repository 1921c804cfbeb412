#pragma once
#include <string>

namespace tape::tapesim {
/// Every setting of a scene that is a field of a settings struct, with default, unit, range and meaning, as a table.
std::string settings_text();
}  // namespace tape::tapesim
