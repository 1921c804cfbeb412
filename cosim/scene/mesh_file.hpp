#pragma once
#include <filesystem>
#include <string>

#include "tape/model/triangle_mesh.hpp"

namespace cosim {
/// Triangles of an STL, OBJ or DAE file. Coordinates are taken as they are written (a DAE's up axis is not applied, its unit is),
/// polygons are cut into triangles, lines and points are left out, equal vertices are made one. The importer works in single
/// precision: 1e-7 of the coordinates; it runs in a child process, because it (assimp 5.2) crashes or fills the memory on some broken
/// files.
/// @param scale     of the file's unit to metres
/// @param asked_by  start of messages
/// @throws InputError if the file cannot be read
tape::TriangleMesh load_mesh(const std::filesystem::path& file, double scale, const std::string& asked_by);

/// The same from memory. @param extension  of the format, without a dot
tape::TriangleMesh parse_mesh(const std::string& bytes, const std::string& extension, double scale, const std::string& asked_by);
}  // namespace cosim
