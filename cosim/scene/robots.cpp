#include "cosim/scene/robots.hpp"

#include <algorithm>

#include "cosim/scene/pose.hpp"
#include "robot/control/line_move.hpp"
#include "robot/control/postures.hpp"
#include "robot/control/trajectory_file.hpp"
#include "robot/kinematics/forward_kinematics.hpp"
#include "robot/kinematics/joint_map.hpp"
#include "robot/urdf/read_urdf.hpp"

namespace cosim {
namespace {
constexpr Real kForever = 1e6;      // [s]
constexpr Real kAcceleration = 10;  // [rad/s^2 or m/s^2] of motions that name no duration: a URDF file has no such limit

/// What the robot's side refuses, at the place of the scene that asks for it.
template <class F>
auto at_place(const Reader& where, const F& f) {
  try {
    return f();
  } catch (const robot::InputError& e) {
    where.fail(e.what());
  }
}

std::vector<std::string> joint_names(const robot::RobotModel& model) {
  std::vector<std::string> names;
  for (const robot::Joint& joint : model.joints) names.push_back(joint.name);
  return names;
}

/// A number for all joints, a list, or a section of joints.
robot::VecX per_joint(const Reader& section, const robot::RobotModel& model, Real fallback, Range range, const char* unit) {
  const auto n = static_cast<Eigen::Index>(model.joints.size());
  robot::VecX out = robot::VecX::Constant(n, fallback);
  if (section.is_list()) {
    const std::vector<Real> all = section.numbers(model.joints.size(), range, unit);
    out = Eigen::Map<const robot::VecX>(all.data(), n);
  } else if (section.is_map()) {
    for (const std::string& name : section.keys())
      out[static_cast<Eigen::Index>(choose(section, name, joint_names(model)))] = section[name].number(range, unit);
  } else if (section) {
    out.setConstant(section.number(range, unit));
  }
  return out;
}

void read_drives(const Reader& drives, RobotPart& part) {
  const robot::VecX kp = per_joint(drives["kp"], *part.model, 0, Range::non_negative(), "N m/rad or N/m");
  const robot::VecX kd = per_joint(drives["kd"], *part.model, 0, Range::non_negative(), "N m s/rad or N s/m");
  const robot::VecX effort = per_joint(drives["effort"], *part.model, std::numeric_limits<Real>::infinity(), Range::positive(), "N m or N");
  for (Eigen::Index k = 0; k < kp.size(); ++k) part.params.drives.push_back({kp[k], kd[k], effort[k]});
}

RobotPart read_robot(const Reader& section, const std::string& name, const SceneFile& file) {
  const Reader urdf = section["urdf"];
  std::filesystem::path found;
  for (const char* folder : {"robots", "props"})
    if (found.empty()) found = find_file(file.path(), folder, urdf.text());
  if (found.empty()) urdf.fail("no such file beside the scene, above it, or in data/robots or data/props");
  robot::UrdfOptions options;
  if (const Reader root = section["package_root"]) options.package_root = file.path().parent_path() / root.text();
  if (const Reader srdf = section["srdf"]) options.srdf = file.path().parent_path() / srdf.text();
  RobotPart part{.name = name};
  part.model = at_place(urdf, [&] { return std::make_shared<const robot::RobotModel>(robot::read_urdf(found, options)); });
  const Pose pose = read_pose(section);
  part.params.X_WB.linear() = pose.rotation, part.params.X_WB.translation() = pose.position;
  part.params.fixed_base = section["base"].text_or("fixed") == "fixed";
  if (const Reader base = section["base"]) choose(base, {"fixed", "free"});
  part.params.friction = section["friction"].number_or(0.5, Range::non_negative(), "");
  part.velocity = section["velocity"].vector_or(part.velocity, kPlace, "m/s");
  part.xi = section["xi"].number_or(0, Range::closed(0, 0.01), "m");
  read_drives(section["drives"], part);
  const robot::JointMap map = at_place(section, [&] { return joint_map(*part.model); });
  const robot::VecX wanted = per_joint(section["joints"], *part.model, 0, kPlace, "rad or m");
  part.start = map.all(map.independent_of(wanted).cwiseMax(map.lower).cwiseMin(map.upper));
  for (Eigen::Index u = 0; section["joints"] && u < map.lower.size(); ++u) {
    const int k = map.independent[static_cast<std::size_t>(u)];
    if (wanted[k] != part.start[k])
      section["joints"].fail(part.model->joints[static_cast<std::size_t>(k)].name + " = " + tape::to_text(wanted[k]) +
                             " (allowed: " + tape::to_text(map.lower[u]) + " to " + tape::to_text(map.upper[u]) + ")");
  }
  return part;
}

/// Where a robot is told to be at a time.
robot::VecX told(const RobotPart& part, Real time) {
  robot::VecX q = part.start;
  const std::vector<robot::JointCommand> commands = commands_at(part, time);
  for (std::size_t k = 0; k < commands.size(); ++k) q[static_cast<Eigen::Index>(k)] = commands[k].position;
  return q;
}

robot::JointTrajectory to_joints(const Reader& entry, const RobotPart& part, const robot::VecX& q) {
  const Reader section = entry["joints"];
  const std::vector<std::string> names = section.keys();
  robot::VecX from(static_cast<Eigen::Index>(names.size())), to = from;
  for (std::size_t k = 0; k < names.size(); ++k) {
    const auto i = static_cast<Eigen::Index>(k);
    from[i] = q[static_cast<Eigen::Index>(choose(section, names[k], joint_names(*part.model)))];
    to[i] = section[names[k]].number(kPlace, "rad or m");
  }
  const robot::MotionLimits limits = robot::motion_limits(*part.model, names, 1, kAcceleration);
  if (const Reader duration = entry["duration"])
    return robot::trajectory_at(names, {from, to}, {0, duration.number(Range::above(0, kForever), "s")},
                                {limits.speed, limits.acceleration * 1e6});
  return robot::trajectory_within(names, {from, to}, limits);
}

robot::JointTrajectory to_posture(const Reader& entry, const SceneFile& file, const RobotPart& part, const robot::VecX& q) {
  const Reader posture = entry["posture"], from = entry["postures"];
  const std::filesystem::path found = find_file(file.path(), "robots", from.text_or("hand_postures.yaml"));
  if (found.empty()) from.fail("no such file beside the scene, above it, or in data/robots");
  return robot::read_postures(found).move(*part.model, entry["prefix"].text_or(""), q, posture.text(),
                                          entry["duration"].number_or(0.5, Range::above(0, kForever), "s"));
}

robot::JointTrajectory to_frame(const Reader& entry, const RobotPart& part, const robot::VecX& q) {
  const Reader name = entry["frame"], by = entry["by"], to = entry["to"];
  const std::optional<robot::Frame> frame = part.model->find_frame(name.text());
  if (!frame) name.fail("the robot has no link or frame of this name");
  if (by.exists() == to.exists()) entry.fail("needs either by or to");
  const robot::Pose now = frame_pose(link_poses(*part.model, q, part.params.X_WB), *frame);
  robot::FrameTarget target{.frame = *frame, .X_WT = now};
  target.X_WT.translation() = by ? Vec3(now.translation() + by.vector(kPlace, "m")) : to.vector(kPlace, "m");
  if (const Reader rotation = entry["rotation_deg"]) target.X_WT.linear() = read_rotation(rotation);
  robot::LineLimits limits;
  limits.speed = entry["speed"].number_or(limits.speed, Range::above(0, 1e3), "m/s");
  const robot::LineMove move = line_move(*part.model, target, q, limits, {}, 100, part.params.X_WB);
  if (!move.failure.empty())
    entry.fail("the way cannot be followed beyond " + tape::to_text(100 * move.fraction) + " % of it: " + move.failure);
  return move.trajectory;
}
}  // namespace

RobotScene read_robots(const SceneFile& file, const Vec3& gravity, const std::function<int(const std::string&)>& material) {
  RobotScene scene;
  const Reader section = file["robots"];
  file.read("exchange", scene.exchange);
  scene.world.gravity = gravity;
  scene.world.substep = file["physics"]["substep"].number_or(scene.world.substep, Range::above(0, 0.1), "s");
  for (const std::string& name : section.keys()) {
    if (name.find_first_of(".: ") != std::string::npos) section[name].fail("a name holds neither dots, colons nor spaces");
    RobotPart& part = scene.robots.emplace_back(read_robot(section[name], name, file));
    part.material = material(section[name]["material"].text_or(name));
  }
  return scene;
}

Real read_robot_motion(const Reader& entry, const SceneFile& file, Real start, RobotScene& robots) {
  std::vector<std::string> names;
  for (const RobotPart& part : robots.robots) names.push_back(part.name);
  const Reader name = entry["robot"];
  if (names.empty()) name.fail("the scene has no robots");
  RobotPart& part = robots.robots[choose(name, names)];
  const robot::VecX q = told(part, start);
  robot::JointTrajectory motion = at_place(entry, [&] {
    if (entry["joints"]) return to_joints(entry, part, q);
    if (entry["posture"]) return to_posture(entry, file, part, q);
    if (entry["frame"]) return to_frame(entry, part, q);
    const Reader trajectory = entry["trajectory"];
    if (!trajectory) entry.fail("must hold one of joints, posture, frame, trajectory");
    return robot::read_trajectory(file.path().parent_path() / trajectory.text(), *part.model, joint_names(*part.model));
  });
  const Real offset = start - motion.start();
  for (Real& time : motion.times) time += offset;
  const Real end = motion.end();
  part.motions.push_back(std::move(motion));
  return end;
}
}  // namespace cosim
