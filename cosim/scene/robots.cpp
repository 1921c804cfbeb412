#include "cosim/scene/robots.hpp"

#include <fnmatch.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "cosim/scene/pose.hpp"
#include "robot/control/line_move.hpp"
#include "robot/control/postures.hpp"
#include "robot/control/trajectory_file.hpp"
#include "robot/kinematics/forward_kinematics.hpp"
#include "robot/kinematics/joint_map.hpp"
#include "robot/model/weld.hpp"
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

/// The joints that a name means; in one that no joint bears a * stands for any text.
std::vector<Eigen::Index> find_joints(const Reader& section, const std::string& name, const robot::RobotModel& model) {
  if (const int exact = model.find_joint(name); exact >= 0) {
    if (model.joints[static_cast<std::size_t>(exact)].mimic)
      section[name].fail("the joint follows another: it has no drive and no position of its own");
    return {exact};
  }
  const std::vector<std::string> all = joint_names(model);
  std::vector<Eigen::Index> found;
  for (std::size_t k = 0; k < all.size(); ++k)
    if (fnmatch(name.c_str(), all[k].c_str(), 0) == 0) found.push_back(static_cast<Eigen::Index>(k));
  if (found.empty()) choose(section[name], name, all);
  return found;
}

std::filesystem::path find_postures(const Reader& asked_by, const std::filesystem::path& scene, const std::string& name) {
  std::filesystem::path found = find_file(scene, "robots", name);
  if (found.empty()) asked_by.fail("no file " + name + " beside the scene, above it, or in data/robots");
  return found;
}
robot::HandPostures load_postures(const Reader& asked_by, const std::filesystem::path& file) {
  return at_place(asked_by, [&] { return robot::read_postures(file); });
}
std::vector<Eigen::Index> joints_of(const robot::HandPostures& postures, const std::string& prefix, const Reader& asked_by,
                                    const robot::RobotModel& model) {
  std::vector<Eigen::Index> joints;
  const std::vector<std::string> all = joint_names(model);
  const std::set<std::string, std::less<>> names(all.begin(), all.end());
  for (const std::string& joint : postures.joints_of(prefix))
    if (const int k = model.find_joint(joint); k >= 0)
      joints.push_back(k);
    else
      asked_by.fail("the robot has no joint " + joint + " (the prefix '" + prefix + "' and a joint of the postures); " +
                    suggestion(joint, names));
  return joints;
}

/// A number for all joints, a list, or a section of joints, of which later entries override earlier ones.
robot::VecX per_joint(const Reader& section, const robot::RobotModel& model, const robot::VecX& fallback, Range range, const char* unit) {
  const auto n = static_cast<Eigen::Index>(model.joints.size());
  robot::VecX out = fallback;
  if (section.is_list()) {
    const std::vector<Real> all = section.numbers(model.joints.size(), range, unit);
    out = Eigen::Map<const robot::VecX>(all.data(), n);
  } else if (section.is_map()) {
    for (const std::string& name : section.keys()) out(find_joints(section, name, model)).setConstant(section[name].number(range, unit));
  } else if (section) {
    out.setConstant(section.number(range, unit));
  }
  return out;
}

/// Postures of hands, each under the prefix of its hand's joints; zero where there is none.
robot::VecX posed(const Reader& postures, const std::filesystem::path& scene, const robot::RobotModel& model) {
  robot::VecX q = robot::VecX::Zero(static_cast<Eigen::Index>(model.joints.size()));
  if (!postures) return q;
  const robot::HandPostures known = load_postures(postures, find_postures(postures, scene, "hand_postures.yaml"));
  for (const std::string& prefix : postures.keys()) {
    const robot::VecX angles = at_place(postures[prefix], [&] { return known.angles(model, prefix, postures[prefix].text()); });
    q(joints_of(known, prefix, postures[prefix], model)) = angles;
  }
  return q;
}

/// @param q  [nj] as the section says; joints that mimic do not count
void require_within_limits(const Reader& section, const robot::RobotModel& model, const robot::JointMap& map, const robot::VecX& q) {
  for (Eigen::Index u = 0; u < map.lower.size(); ++u) {
    const int k = map.independent[static_cast<std::size_t>(u)];
    const std::string& name = model.joints[static_cast<std::size_t>(k)].name;
    if (q[k] < map.lower[u] || q[k] > map.upper[u])
      (section.is_map() && section[name] ? section[name] : section)
          .fail(name + " = " + tape::to_text(q[k]) + " (allowed: " + tape::to_text(map.lower[u]) + " to " + tape::to_text(map.upper[u]) +
                ")");
  }
}

bool has_drive(const RobotPart& part, int joint) {
  const robot::DriveGains& gains = part.params.drives[static_cast<std::size_t>(joint)];
  return gains.kp > 0 || gains.kd > 0;
}

void read_drives(const Reader& drives, const robot::JointMap& map, RobotPart& part) {
  const auto n = static_cast<Eigen::Index>(part.model->joints.size());
  const robot::VecX none = robot::VecX::Zero(n), unlimited = robot::VecX::Constant(n, std::numeric_limits<Real>::infinity());
  const robot::VecX kp = per_joint(drives["kp"], *part.model, none, Range::non_negative(), "N m/rad or N/m");
  const robot::VecX kd = per_joint(drives["kd"], *part.model, none, Range::non_negative(), "N m s/rad or N s/m");
  const robot::VecX effort = per_joint(drives["effort"], *part.model, unlimited, Range::positive(), "N m or N");
  for (Eigen::Index k = 0; k < kp.size(); ++k) part.params.drives.push_back({kp[k], kd[k], effort[k]});
  part.params.compensate_gravity = drives["compensate_gravity"].flag_or(false);
  if (part.params.compensate_gravity && kp.isZero(0) && kd.isZero(0)) drives["compensate_gravity"].fail("no joint has a drive (kp, kd)");
  if (const Reader target = drives["target"]) {
    if (kp.isZero(0)) target.fail("no joint has a drive that would hold it there (kp)");
    part.target = per_joint(target, *part.model, part.start, kPlace, "rad or m");
    require_within_limits(target, *part.model, map, part.target);
  }
}

robot::RobotModel load_robot(const Reader& section, const SceneFile& file) {
  const Reader urdf = section["urdf"];
  std::filesystem::path found;
  for (const char* folder : {"robots", "props"})
    if (found.empty()) found = find_file(file.path(), folder, urdf.text());
  if (found.empty()) urdf.fail("no such file beside the scene, above it, or in data/robots or data/props");
  robot::UrdfOptions options;
  if (const Reader root = section["package_root"]) options.package_root = file.path().parent_path() / root.text();
  if (const Reader srdf = section["srdf"]) options.srdf = file.path().parent_path() / srdf.text();
  return at_place(urdf, [&] { return robot::read_urdf(found, options); });
}

robot::Pose to_robot(const Pose& pose) {
  robot::Pose out = robot::Pose::Identity();
  out.linear() = pose.rotation, out.translation() = pose.position;
  return out;
}

/// With the tools that it carries.
robot::RobotModel load_welded(const Reader& section, const SceneFile& file) {
  robot::RobotModel model = load_robot(section, file);
  for (const Reader& tool : section["welds"].items())
    model = at_place(tool, [&] { return weld(model, tool["to"].text(), load_robot(tool, file), to_robot(read_pose(tool))); });
  return model;
}

RobotPart read_robot(const Reader& section, const std::string& name, const SceneFile& file, Schedule schedule) {
  RobotPart part{.name = name};
  part.model = std::make_shared<const robot::RobotModel>(load_welded(section, file));
  part.params.X_WB = to_robot(read_pose(section));
  part.params.fixed_base = section["base"].text_or("fixed") == "fixed";
  if (const Reader base = section["base"]) choose(base, {"fixed", "free"});
  if (!part.params.fixed_base && schedule == Schedule::posed)
    section["base"].fail("nobody tells a free base where to be, as exchange.schedule = posed asks");
  part.params.friction = section["friction"].number_or(0.5, Range::non_negative(), "");
  part.velocity = section["velocity"].vector_or(part.velocity, kPlace, "m/s");
  if (const Reader velocity = section["velocity"]; velocity && part.params.fixed_base)
    velocity.fail("the base is fixed (base: free has one)");
  part.xi = section["xi"].number_or(0, Range::closed(0, 0.01), "m");
  const robot::JointMap map = at_place(section, [&] { return joint_map(*part.model); });
  const robot::VecX postures = posed(section["postures"], file.path(), *part.model);
  const robot::VecX unless_set = map.all(map.independent_of(postures).cwiseMax(map.lower).cwiseMin(map.upper));
  const robot::VecX wanted = per_joint(section["joints"], *part.model, unless_set, kPlace, "rad or m");
  if (const Reader joints = section["joints"]) require_within_limits(joints, *part.model, map, wanted);
  part.start = map.all(map.independent_of(wanted));
  read_drives(section["drives"], map, part);
  return part;
}

using Plan = std::function<robot::JointTrajectory(const robot::VecX&)>;
using Model = std::shared_ptr<const robot::RobotModel>;
struct FileAndPlan {
  std::filesystem::path file;  ///< that the numbers come from, or empty
  Plan plan;
};

Plan to_joints(const Reader& entry, const Model& model) {
  const Reader section = entry["joints"];
  const std::vector<std::string> names = section.keys();
  const robot::JointMap map = joint_map(*model);
  std::vector<Eigen::Index> at;
  robot::VecX to(static_cast<Eigen::Index>(names.size()));
  for (std::size_t k = 0; k < names.size(); ++k) {
    const std::size_t joint = choose(section, names[k], joint_names(*model));
    const auto u = std::ranges::find(map.independent, static_cast<int>(joint)) - map.independent.begin();
    if (u == map.lower.size()) section[names[k]].fail("the joint follows another: it has no drive");
    at.push_back(static_cast<Eigen::Index>(joint));
    to[static_cast<Eigen::Index>(k)] = section[names[k]].number(Range::closed(map.lower[u], map.upper[u]), "rad or m");
  }
  const robot::MotionLimits limits = at_place(entry, [&] { return robot::motion_limits(*model, names, 1, kAcceleration); });
  const Real duration = entry["duration"].number_or(0, Range::above(0, kForever), "s");
  return [=](const robot::VecX& q) {
    const robot::VecX from = q(at);
    if (duration == 0) return robot::trajectory_within(names, {from, to}, limits);
    return robot::trajectory_at(names, {from, to}, {0, duration}, {limits.speed, limits.acceleration * 1e6});
  };
}

FileAndPlan to_posture(const Reader& entry, const std::filesystem::path& scene, const Model& model) {
  const Reader from = entry["postures"], &asked_by = from ? from : entry;
  const std::filesystem::path file = find_postures(asked_by, scene, from.text_or("hand_postures.yaml"));
  const robot::HandPostures postures = load_postures(asked_by, file);
  const std::string prefix = entry["prefix"].text_or(""), posture = entry["posture"].text();
  const Real duration = entry["duration"].number_or(0.5, Range::above(0, kForever), "s");
  const std::vector<Eigen::Index> at = joints_of(postures, prefix, entry["posture"], *model);
  return {file, [=](const robot::VecX& q) { return postures.move(*model, prefix, q(at), posture, duration); }};
}

Plan to_frame(const Reader& entry, const Model& model, const robot::Pose& X_WB) {
  const Reader name = entry["frame"], by = entry["by"], to = entry["to"], turned = entry["rotation_deg"];
  const std::optional<robot::Frame> frame = model->find_frame(name.text());
  if (!frame) name.fail("the robot has no link or frame of this name");
  if (by.exists() == to.exists()) entry.fail("needs either by or to");
  const Vec3 where = (by ? by : to).vector(kPlace, "m");
  const std::optional<Mat3> rotation = turned ? std::optional(read_rotation(turned)) : std::nullopt;
  robot::LineLimits limits;
  limits.speed = entry["speed"].number_or(limits.speed, Range::above(0, 1e3), "m/s");
  return [=, relative = by.exists()](const robot::VecX& q) {
    robot::FrameTarget target{.frame = *frame, .X_WT = frame_pose(link_poses(*model, q, X_WB), *frame)};
    target.X_WT.translation() = relative ? Vec3(target.X_WT.translation() + where) : where;
    if (rotation) target.X_WT.linear() = *rotation;
    const robot::LineMove move = line_move(*model, target, q, limits, {}, 100, X_WB);
    if (!move.failure.empty())
      throw robot::InputError("the way cannot be followed beyond " + tape::to_text(100 * move.fraction) + " % of it: " + move.failure);
    return move.trajectory;
  };
}

/// Of the joints that the file names; they must be where it starts.
FileAndPlan along_file(const Reader& entry, const std::filesystem::path& scene, const Model& model) {
  constexpr Real kNear = 0.1;  // [rad or m] from where a joint is told to be to where the file starts
  const Reader trajectory = entry["trajectory"];
  if (!trajectory) entry.fail("must hold one of joints, posture, frame, trajectory");
  const std::filesystem::path file = scene.parent_path() / trajectory.text();
  const auto way = at_place(trajectory, [&] { return robot::read_trajectory(file, *model, robot::joints_in_header(file)); });
  std::vector<Eigen::Index> at;
  for (const std::string& name : way.joints) {
    at.push_back(model->find_joint(name));
    if (model->joints[static_cast<std::size_t>(at.back())].mimic) trajectory.fail("joint " + name + " follows another: it has no drive");
  }
  return {file, [=](const robot::VecX& q) {
            for (std::size_t k = 0; k < at.size(); ++k)
              if (const Real from = q[at[k]], to = way.knots[0][static_cast<Eigen::Index>(k)]; std::fabs(to - from) > kNear)
                throw robot::InputError("joint " + way.joints[k] + " starts at " + tape::to_text(to) +
                                        " in the file, and is told to be at " + tape::to_text(from) + " (allowed: up to " +
                                        tape::to_text(kNear) + " from it): move it there before");
            return robot::JointTrajectory(way);
          }};
}

FileAndPlan read_plan(const Reader& entry, const std::filesystem::path& scene, const RobotPart& part) {
  if (entry["joints"]) return {{}, to_joints(entry, part.model)};
  if (entry["posture"]) return to_posture(entry, scene, part.model);
  if (entry["frame"]) return {{}, to_frame(entry, part.model, part.params.X_WB)};
  return along_file(entry, scene, part.model);
}
}  // namespace

RobotScene read_robots(const SceneFile& file, const Vec3& gravity, const std::function<int(const std::string&)>& material) {
  RobotScene scene;
  const Reader section = file["robots"];
  file.read("exchange", scene.exchange);
  scene.world.gravity = gravity;
  scene.world.substep = file["physics"]["substep"].number_or(scene.world.substep, Range::closed(1e-6, 0.1), "s");
  for (const std::string& name : section.keys()) {
    RobotPart& part = scene.robots.emplace_back(read_robot(section[name], name, file, scene.exchange.schedule));
    part.material = material(section[name]["material"].text_or(name));
  }
  return scene;
}

Lasting add_robot_motion(const Reader& entry, const SceneFile& file, const tape::Moment& start, Real expected,
                         const std::vector<Real>& events, RobotScene& robots) {
  std::vector<std::string> names;
  for (const RobotPart& part : robots.robots) names.push_back(part.name);
  const Reader name = entry["robot"];
  if (names.empty()) name.fail("the scene has no robots");
  RobotPart& part = robots.robots[choose(name, names)];
  if (!part.motions.empty())
    if (const Real last = part.motions.back().start.at(events); expected < last)
      name.fail("starts at " + tape::to_text(expected) + " s, before the motion ahead of it in the script starts at " +
                tape::to_text(last) + " s");
  const FileAndPlan read = read_plan(entry, file.path(), part);
  const robot::VecX q = RobotScript(part, events).told_at(expected);
  const robot::JointTrajectory planned = at_place(entry, [&] { return read.plan(q); });
  if (robots.exchange.schedule != Schedule::posed)
    for (const std::string& joint : planned.joints)
      if (!has_drive(part, part.model->find_joint(joint)))
        entry.fail("joint " + joint + " has no drive that would follow (drives: kp and kd of the robot)");
  const auto with_place = [plan = read.plan, where = entry.where()](const robot::VecX& from) {
    try {
      return plan(from);
    } catch (const robot::InputError& e) {
      throw tape::InputError(where + ": " + e.what());
    }
  };
  part.motions.push_back({with_place, start, planned.end() - planned.start(), -1, read.file});
  return {part.motions.back().duration, &part.motions.back().until};
}
}  // namespace cosim
