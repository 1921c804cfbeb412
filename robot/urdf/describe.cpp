#include "robot/urdf/describe.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "robot/kinematics/forward_kinematics.hpp"
#include "robot/kinematics/joint_map.hpp"
#include "robot/model/inertia.hpp"

namespace robot {
namespace {
const char* name_of(JointType type) {
  switch (type) {
    case JointType::revolute:
      return "revolute";
    case JointType::continuous:
      return "continuous";
    case JointType::prismatic:
      break;
  }
  return "prismatic";
}

std::string name_of(Shape::Kind kind, std::size_t count) {
  switch (kind) {
    case Shape::Kind::box:
      return count == 1 ? "box" : "boxes";
    case Shape::Kind::cylinder:
      return count == 1 ? "cylinder" : "cylinders";
    case Shape::Kind::sphere:
      return count == 1 ? "sphere" : "spheres";
    case Shape::Kind::mesh:
      break;
  }
  return count == 1 ? "mesh" : "meshes";
}

Real travel(const Joint& joint) { return joint.type == JointType::prismatic ? std::max(-joint.lower, joint.upper) : 0; }

/// ", visual: 2 boxes, 1 mesh of 12 triangles"; empty without shapes.
std::string shapes_text(const char* what, const std::vector<Shape>& shapes) {
  std::string text;
  for (const auto kind : {Shape::Kind::box, Shape::Kind::cylinder, Shape::Kind::sphere, Shape::Kind::mesh}) {
    std::size_t count = 0, triangles = 0;
    for (const Shape& s : shapes)
      if (s.kind == kind) ++count, triangles += s.mesh.triangles.size();
    if (count == 0) continue;
    text += fmt::format("{} {} {}", text.empty() ? "" : ",", count, name_of(kind, count));
    if (kind == Shape::Kind::mesh) text += fmt::format(" of {} triangles", triangles);
  }
  return text.empty() ? "" : fmt::format(", {}:{}", what, text);
}

std::string link_text(const Link& link) {
  const Inertial& i = link.inertial;
  std::string text = "link " + link.name;
  if (i.mass > 0) {
    const Vec3 m = principal_moments(i.inertia);
    text += fmt::format(": {:.5g} kg, com [{:.4g}, {:.4g}, {:.4g}] m, principal moments [{:.4g}, {:.4g}, {:.4g}] kg m^2", i.mass, i.com.x(),
                        i.com.y(), i.com.z(), m[0], m[1], m[2]);
  } else {
    text += ": no mass";
  }
  return text + shapes_text("visual", link.visual) + shapes_text("collision", link.collision);
}

std::string joint_text(const RobotModel& robot, const Joint& joint) {
  const bool slides = joint.type == JointType::prismatic;
  const auto limit = [](Real value, const char* unit) { return std::isinf(value) ? "unlimited" : fmt::format("{:.5g} {}", value, unit); };
  std::string text = fmt::format("joint {}: {} about [{:.4g}, {:.4g}, {:.4g}]", joint.name, name_of(joint.type), joint.axis.x(),
                                 joint.axis.y(), joint.axis.z());
  if (slides) text.replace(text.find(" about "), 7, " along ");
  text += fmt::format(", {:.5g} to {:.5g} {}, effort {}, velocity {}", joint.lower, joint.upper, slides ? "m" : "rad",
                      limit(joint.effort, slides ? "N" : "N m"), limit(joint.velocity, slides ? "m/s" : "rad/s"));
  if (joint.damping > 0) text += fmt::format(", damping {:.4g} {}", joint.damping, slides ? "N s/m" : "N m s/rad");
  if (joint.friction > 0) text += fmt::format(", friction {:.4g} {}", joint.friction, slides ? "N" : "N m");
  if (joint.mimic)
    text += fmt::format(", mimics {:.5g} * {} + {:.5g}", joint.mimic->multiplier,
                        robot.joints[static_cast<std::size_t>(joint.mimic->joint)].name, joint.mimic->offset);
  return text;
}

void add_tree(const RobotModel& robot, int link, const std::string& indent, std::string& text) {
  text += indent + link_text(robot.links[static_cast<std::size_t>(link)]) + "\n";
  for (const Frame& frame : robot.frames)
    if (frame.link == link) {
      const Vec3 p = frame.X_LF.translation();
      text += fmt::format("{}  frame {} at [{:.4g}, {:.4g}, {:.4g}] m\n", indent, frame.name, p.x(), p.y(), p.z());
    }
  for (std::size_t j = 0; j < robot.joints.size(); ++j)
    if (robot.joints[j].parent == link) {
      text += indent + "  " + joint_text(robot, robot.joints[j]) + "\n";
      add_tree(robot, static_cast<int>(j) + 1, indent + "  ", text);
    }
}
}  // namespace

Reach reach(const RobotModel& robot) {
  Reach reach{.at_zero = 0, .farthest = robot.links.front().name, .bound = 0, .longest_path = robot.links.front().name};
  const std::vector<Pose> X_BL = link_poses(robot, joint_map(robot).offset);
  std::vector<Real> path(robot.links.size(), 0);
  const auto look = [&](const std::string& name, Real distance, Real bound) {
    if (distance > reach.at_zero) reach.at_zero = distance, reach.farthest = name;
    if (bound > reach.bound) reach.bound = bound, reach.longest_path = name;
  };
  for (std::size_t j = 0; j < robot.joints.size(); ++j) {
    const Joint& joint = robot.joints[j];
    path[j + 1] = path[static_cast<std::size_t>(joint.parent)] + joint.X_PJ.translation().norm() + travel(joint);
    look(robot.links[j + 1].name, X_BL[j + 1].translation().norm(), path[j + 1]);
  }
  for (const Frame& f : robot.frames) {
    look(f.name, frame_pose(X_BL, f).translation().norm(), path[static_cast<std::size_t>(f.link)] + f.X_LF.translation().norm());
  }
  return reach;
}

Real total_mass(const RobotModel& robot) {
  Real mass = 0;
  for (const Link& link : robot.links) mass += link.inertial.mass;
  return mass;
}

std::string describe(const RobotModel& robot) {
  const auto mimics = std::count_if(robot.joints.begin(), robot.joints.end(), [](const Joint& j) { return j.mimic.has_value(); });
  std::string text = fmt::format("robot {}: links: {}, joints: {} ({} of them mimic), frames of merged links: {}\n", robot.name,
                                 robot.links.size(), robot.joints.size(), mimics, robot.frames.size());
  add_tree(robot, 0, "", text);
  const Reach r = reach(robot);
  text += fmt::format("mass: {:.5g} kg in all\n", total_mass(robot));
  text +=
      fmt::format("reach: {} is farthest from the base at q = 0, {:.4g} m; no frame gets beyond {:.4g} m, the length of the path to {}\n",
                  r.farthest, r.at_zero, r.bound, r.longest_path);
  text += fmt::format("pairs of links that may overlap: {}\n", robot.may_overlap.size());
  for (const std::string& note : robot.notes) text += "note: " + note + "\n";
  return text;
}
}  // namespace robot
