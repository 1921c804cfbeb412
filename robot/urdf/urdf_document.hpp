#pragma once
#include <filesystem>
#include <string>
#include <vector>

namespace robot {
/// A URDF file, checked where urdfdom checks nothing or says little, and tidied where urdfdom is stricter than the files in use.
struct UrdfDocument {
  std::string text;                    ///< what urdfdom reads
  std::vector<std::string> joints;     ///< in the order of the file, which urdfdom does not keep
  std::vector<std::string> unlimited;  ///< "effort of elbow": limits that are missing or 0
  std::vector<std::string> notes;
};

/// Refused: what is no XML or no robot, xacro that is not expanded, numbers that are none or out of range, duplicate names, joints that
/// name unknown links or cannot move, more than one root, loops, revolute and prismatic joints without limits. Tidied: white space and
/// signs of numbers; what fixed joints say about motion, and the inertia of links that hang on them if all of it is 0; off-diagonal terms
/// of inertias that are left out; axes without numbers; limits that are infinite; materials that are not defined, defined again, or of no
/// colour. Noted: what stands in links and joints and is not read.
/// @throws InputError naming file, line, element, value and what is allowed
UrdfDocument read_document(const std::filesystem::path& file);
}  // namespace robot
