#include "robot/model/weld.hpp"

#include "robot/model/inertia.hpp"

namespace robot {
namespace {
void add_shapes(const std::vector<Shape>& shapes, const Pose& X_LT, std::vector<Shape>& to) {
  for (Shape shape : shapes) {
    shape.X_LS = X_LT * shape.X_LS;
    to.push_back(std::move(shape));
  }
}

void require_new_names(const RobotModel& robot, const RobotModel& tool) {
  const auto refuse = [&](const std::string& what, const std::string& name) {
    throw InputError(tool.name + " cannot be welded to " + robot.name + ": both have a " + what + " named " + name);
  };
  for (const Joint& joint : tool.joints)
    if (robot.find_joint(joint.name) >= 0) refuse("joint", joint.name);
  for (const Link& link : tool.links)
    if (robot.find_frame(link.name)) refuse("link", link.name);
  for (const Frame& frame : tool.frames)
    if (robot.find_frame(frame.name)) refuse("frame", frame.name);
}
}  // namespace

RobotModel weld(const RobotModel& robot, const std::string& frame, const RobotModel& tool, const Pose& X_FT) {
  const std::optional<Frame> at = robot.find_frame(frame);
  if (!at) throw InputError(robot.name + " has no link or frame named " + frame);
  require_new_names(robot, tool);
  RobotModel out = robot;
  const Pose X_LT = at->X_LF * X_FT;
  const int first = static_cast<int>(robot.links.size()), joints = static_cast<int>(robot.joints.size());
  const auto link = [&](int of_tool) { return of_tool == 0 ? at->link : first + of_tool - 1; };
  Link& carrier = out.links[static_cast<std::size_t>(at->link)];
  const Link& base = tool.links[0];
  if (base.inertial.mass > 0) carrier.inertial = combined(carrier.inertial, moved(X_LT, base.inertial));
  add_shapes(base.visual, X_LT, carrier.visual);
  add_shapes(base.collision, X_LT, carrier.collision);
  out.links.insert(out.links.end(), tool.links.begin() + 1, tool.links.end());
  for (Joint joint : tool.joints) {
    if (joint.parent == 0) joint.X_PJ = X_LT * joint.X_PJ;
    joint.parent = link(joint.parent);
    if (joint.mimic) joint.mimic->joint += joints;
    out.joints.push_back(std::move(joint));
  }
  out.frames.push_back({base.name, at->link, X_LT});
  for (const Frame& f : tool.frames) out.frames.push_back({f.name, link(f.link), f.link == 0 ? Pose(X_LT * f.X_LF) : f.X_LF});
  for (const auto& [a, b] : tool.may_overlap) out.may_overlap.emplace_back(link(a), link(b));
  out.notes.insert(out.notes.end(), tool.notes.begin(), tool.notes.end());
  if (base.inertial.mass == 0 && !(base.visual.empty() && base.collision.empty()))
    out.notes.push_back(tool.name + ": no inertia is given for its base " + base.name + "; it adds none");
  out.notes.push_back(tool.name + " is welded to " + frame);
  return out;
}
}  // namespace robot
