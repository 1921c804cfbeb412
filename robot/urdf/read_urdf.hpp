#pragma once
#include <filesystem>

#include "robot/model/robot_model.hpp"

namespace robot {
struct UrdfOptions {
  std::filesystem::path package_root = {};  ///< folder of packages, or of one; empty: found from the URDF file upward (mesh_uri.hpp)
  std::filesystem::path srdf = {};          ///< empty: the file beside the URDF file whose name ends in .srdf instead, if there is one
  bool honour_up_axis = false;              ///< turn COLLADA meshes by the up axis that they name (mesh_file.hpp)
};

/// A robot from a URDF file. Links and joints are in the order of the file, depth first. Links on fixed joints become part of the link that
/// they hang on, and a frame of it; mimic joints follow a joint that follows none. README.md says what is taken as what.
/// @throws InputError naming file, element, value and what is allowed
RobotModel read_urdf(const std::filesystem::path& file, const UrdfOptions& options = {});
}  // namespace robot
