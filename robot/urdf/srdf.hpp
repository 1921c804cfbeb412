#pragma once
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

namespace robot {
/// Pairs of links, by name, whose collisions an SRDF file disables.
/// @throws InputError naming the file if it is missing, no SRDF, or an entry lacks a link
std::vector<std::pair<std::string, std::string>> read_disabled_collisions(const std::filesystem::path& file);
}  // namespace robot
