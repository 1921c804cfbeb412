#pragma once
#include <filesystem>

#include "cosim/episode/episode.hpp"
#include "cosim/scene/reader.hpp"

namespace cosim {
/// The file that a key names: find_file from EPISODE.yaml.  @throws InputError "file:line: key = value: ..." if there is none
std::filesystem::path named_file(const Reader& name, const std::filesystem::path& from, const std::string& subfolder);

/// `recording` of an EPISODE.yaml (README.md): the name of an episode's HDF5 file, or a section that imports what others recorded.
/// @param from  EPISODE.yaml, beside which files are looked for
/// @throws InputError "file:line: key = value: reason", and what read_episode and the imports refuse
Episode read_recording(const Reader& recording, const std::filesystem::path& from);
}  // namespace cosim
