#pragma once
#include <gtest/gtest.h>

#include <string>

#include "robot/urdf/read_urdf.hpp"
#include "tests/robot/support/folder.hpp"

/// Small robots, written by the tests.
namespace robot::test {
inline std::string robot_text(const std::string& content) {
  return "<?xml version=\"1.0\"?>\n<robot name=\"r\">\n" + content + "</robot>\n";
}

/// @param content  of the element <robot>
inline RobotModel read_text(const std::string& content, const UrdfOptions& options = {}) {
  const Folder folder;
  return read_urdf(folder.write("r.urdf", robot_text(content)), options);
}

/// What is said when it is refused.
inline std::string refusal(const std::string& content, const UrdfOptions& options = {}) {
  try {
    read_text(content, options);
  } catch (const InputError& e) {
    return e.what();
  }
  ADD_FAILURE() << "accepted:\n" << content;
  return "";
}

/// An inertia that any body of these tests may have: a cube of 1 kg and edge 0.1 m.
inline const std::string kBody =
    R"(<inertial><mass value="1"/><inertia ixx="0.00166667" ixy="0" ixz="0" iyy="0.00166667" iyz="0" izz="0.00166667"/></inertial>)";

inline std::string link_text(const std::string& name, const std::string& content = kBody) {
  return "<link name=\"" + name + "\">" + content + "</link>\n";
}

inline std::string joint_text(const std::string& name, const std::string& type, const std::string& parent, const std::string& child,
                              const std::string& content = "") {
  return "<joint name=\"" + name + "\" type=\"" + type + "\"><parent link=\"" + parent + "\"/><child link=\"" + child + "\"/>" + content +
         "</joint>\n";
}

inline const std::string kLimit = R"(<limit lower="-1" upper="2" effort="3" velocity="4"/>)";

/// base - arm, by one revolute joint about z.
inline std::string one_joint(const std::string& joint_content, const std::string& arm = kBody) {
  return link_text("base", "") + link_text("arm", arm) +
         joint_text("elbow", "revolute", "base", "arm", "<axis xyz=\"0 0 1\"/>" + joint_content);
}
}  // namespace robot::test
