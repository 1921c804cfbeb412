#pragma once
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

namespace robot {
/// Pairs of links, by name, whose collisions an SRDF file disables, MoveIt 2's defaults of a link included.
/// @param links  names of all that the robot has
/// @throws InputError naming the file if it is missing, no SRDF, or an entry lacks a link
std::vector<std::pair<std::string, std::string>> read_disabled_collisions(const std::filesystem::path& file,
                                                                          const std::vector<std::string>& links);
}  // namespace robot
