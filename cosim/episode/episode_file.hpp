#pragma once
#include <filesystem>

#include "cosim/episode/episode.hpp"

namespace cosim {
/// Writes an episode as the HDF5 file that README.md describes.
/// @throws InputError if the episode is not sound, or the file cannot be written
void write_episode(const std::filesystem::path& file, const Episode& episode);

/// @throws InputError naming the file and the array, for what is missing, of another shape or unit, or not sound
Episode read_episode(const std::filesystem::path& file);
}  // namespace cosim
