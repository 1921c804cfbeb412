#pragma once
#include <filesystem>
#include <string>

namespace robot {
/// The file that a mesh URI of a URDF file means. Looked for, in this order:
/// - package://NAME/REST (and model://): NAME/REST, then REST, in `package_root`; NAME/REST in each folder from that of the URDF file
///   upward, and REST in those that are called NAME; at last REST in each folder upward, because exported packages get renamed;
/// - file:///PATH, and absolute paths: there;
/// - relative paths: in the folder of the URDF file, in `package_root`, in each folder upward.
/// A %20 stands for a space where no file has it in its name.
/// @param owner  for the message: which link asks
/// @throws InputError naming the URDF file, the link, the URI and where it was looked for
std::filesystem::path find_mesh(const std::string& uri, const std::filesystem::path& urdf, const std::filesystem::path& package_root,
                                const std::string& owner);
}  // namespace robot
