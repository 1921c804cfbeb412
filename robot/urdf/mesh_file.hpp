#pragma once
#include <filesystem>

#include "robot/model/robot_model.hpp"

namespace robot {
/// Triangles of a mesh file of any format that assimp reads: STL, OBJ, COLLADA, glTF... Vertices in the same place are one.
/// Lengths are metres: COLLADA files say what their unit is, others hold metres. The z axis is up:
/// - glTF files are y-up by definition and are turned, so that their y becomes z;
/// - COLLADA files may name their up axis. Most robots in use were made for RViz, MoveIt and Gazebo, which do not read it, and many name a
///   wrong one; so coordinates stay as they are written. `honour_up_axis` turns Y_UP and X_UP to z.
/// @param scale  [3] of the URDF file; a negative one mirrors the mesh, and its triangles are turned over to face outward again
/// @throws InputError naming the file if it cannot be read or holds no triangle
TriangleMesh read_mesh(const std::filesystem::path& file, const Vec3& scale = Vec3::Ones(), bool honour_up_axis = false);
}  // namespace robot
