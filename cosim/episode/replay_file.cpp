#include "cosim/episode/replay_file.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "cosim/episode/camera_file.hpp"
#include "cosim/episode/episode_file.hpp"
#include "cosim/episode/resample.hpp"
#include "robot/kinematics/joint_map.hpp"

namespace cosim {
namespace {
namespace fs = std::filesystem;

fs::path named_file(const Reader& name, const fs::path& from, const std::string& subfolder) {
  const fs::path found = find_file(from, subfolder, name.text());
  if (found.empty()) name.fail("there is no such file");
  return found;
}

/// A recorded joint, and its stream.
struct Place {
  const MotionStream* stream;
  std::size_t joint;
  Unit unit() const { return stream->joints[joint].unit; }
};
std::vector<std::pair<std::string, Place>> recorded_joints(const Episode& episode) {
  std::vector<std::pair<std::string, Place>> all;
  for (const MotionStream& stream : episode.streams)
    for (std::size_t j = 0; j < stream.joints.size(); ++j) all.push_back({stream.joints[j].name, {&stream, j}});
  return all;
}

DrivenJoint read_driven(const Reader& entry, const std::string& recorded, Unit unit) {
  const Reader drives = entry["drives"];
  const std::string target = drives.text();
  const std::size_t colon = target.find(':');
  if (colon == target.npos) drives.fail("names no joint of a robot (allowed: robot:joint)");
  DrivenJoint driven{.recorded = recorded, .robot = target.substr(0, colon), .joint = target.substr(colon + 1), .where = drives.where()};
  const Reader stated = entry["unit"];
  if (stated.choice<Unit>() != unit) stated.fail("is recorded in " + to_text(unit) + " (allowed: the same)");
  if (const Reader sign = entry["sign"]) {
    driven.sign = sign.number(Range::closed(-1, 1), "");
    if (std::abs(driven.sign) != 1) sign.fail("is no sign (allowed: 1, -1)");
  }
  const Reader scale = entry["scale"];
  if (unit == Unit::one && !scale) scale.fail("missing; a share moves a joint by a scale in rad or m");
  driven.scale = scale.number_or(1, Range::positive(), "rad or m");
  driven.offset = entry["offset"].number_or(0, Range::closed(-100, 100), "rad or m");
  return driven;
}

std::vector<DrivenJoint> read_joints(const Reader& section, const Episode& episode) {
  if (!section.is_map()) section.fail("missing; must be a section of recorded joints: {drives: robot:joint, unit: rad}, or none");
  const auto recorded = recorded_joints(episode);
  std::vector<std::string> names;
  for (const auto& [name, place] : recorded) names.push_back(name);
  std::vector<DrivenJoint> all;
  const std::vector<std::string> keys = section.keys();
  for (const std::string& name : keys) {
    const Reader entry = section[name];
    if (std::find(names.begin(), names.end(), name) == names.end())
      entry.fail("the recording has no such joint; " + suggestion(name, {names.begin(), names.end()}));
    if (!entry.is_map()) {
      if (!entry || entry.text() != "none") entry.fail("must be {drives: robot:joint, unit: ...}, or none where it drives nothing");
      continue;
    }
    const DrivenJoint driven = read_driven(entry, name, recorded[choose(entry, name, names)].second.unit());
    for (const DrivenJoint& other : all)
      if (other.robot == driven.robot && other.joint == driven.joint) entry["drives"].fail("is driven by " + other.recorded + " already");
    all.push_back(driven);
  }
  for (const std::string& name : names)
    if (std::find(keys.begin(), keys.end(), name) == keys.end())
      section.fail("recorded joint " + name + " is missing (allowed: what it drives, or none)");
  return all;
}

/// The camera of the score; a calibration file takes the place of the recorded one.
std::string read_camera(const SceneFile& file, Episode& episode) {
  const Reader camera = file["camera"], calibration = file["calibration"];
  if (!camera) {
    if (calibration) calibration.fail("is of no camera: camera is missing");
    return "";
  }
  std::vector<std::string> names;
  for (const EpisodeCamera& one : episode.cameras) names.push_back(one.name);
  if (names.empty()) camera.fail("the recording has no camera");
  EpisodeCamera& chosen = episode.cameras[choose(camera, names)];
  if (calibration) {
    chosen.calibration = load_camera(named_file(calibration, file.path(), "cameras")).calibration;
    require_sound(episode, calibration.where() + ": " + calibration.text());
  }
  return chosen.name;
}

/// Knots of the joints of one stream that move one robot.
robot::JointTrajectory trajectory_of(const Replay& replay, const MotionStream& stream, const RobotPart& part) {
  const bool measured = replay.params.follow == Follow::measured;
  const std::vector<robot::VecX>& rows = measured ? stream.measured : stream.commanded;
  robot::JointTrajectory motion{.joints = {}, .times = {}, .knots = {}, .between = robot::JointTrajectory::Between::linear};
  std::vector<std::pair<const DrivenJoint*, std::size_t>> columns;
  for (const DrivenJoint& driven : replay.joints) {
    const auto found =
        std::find_if(stream.joints.begin(), stream.joints.end(), [&](const RecordedJoint& joint) { return joint.name == driven.recorded; });
    if (driven.robot != part.name || found == stream.joints.end()) continue;
    motion.joints.push_back(driven.joint);
    columns.emplace_back(&driven, static_cast<std::size_t>(found - stream.joints.begin()));
  }
  if (columns.empty()) return motion;
  if (rows.empty())
    throw InputError(fmt::format("{}: motion {} has no {} positions", columns[0].first->where, stream.name, to_text(replay.params.follow)));
  require_no_gap(stream, replay.start, replay.params.max_gap, columns[0].first->where);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    robot::VecX q(static_cast<Eigen::Index>(columns.size()));
    for (std::size_t c = 0; c < columns.size(); ++c) {
      const auto& [driven, column] = columns[c];
      const Real recorded = si_per(stream.joints[column].unit) * rows[i][static_cast<Eigen::Index>(column)];
      const Real value = q[static_cast<Eigen::Index>(c)] = driven->sign * driven->scale * recorded + driven->offset;
      const robot::Joint& joint = part.model->joints[static_cast<std::size_t>(part.model->find_joint(driven->joint))];
      if (value < joint.lower - replay.params.slack || value > joint.upper + replay.params.slack)
        throw InputError(
            fmt::format("{}: {} moves {}:{} to {:g} at {:g} s, beyond its limits (allowed: {:g} to {:g} rad or m); are unit, "
                        "sign and offset right?",
                        driven->where, driven->recorded, part.name, driven->joint, value, stream.times[i], joint.lower, joint.upper));
    }
    motion.times.push_back(stream.times[i] - replay.start);
    motion.knots.push_back(q);
  }
  return motion;
}

void require_driveable(const DrivenJoint& driven, const RobotScene& robots) {
  const auto fail = [&](const std::string& reason) {
    throw InputError(driven.where + ": " + driven.robot + ":" + driven.joint + " " + reason);
  };
  const auto part =
      std::find_if(robots.robots.begin(), robots.robots.end(), [&](const RobotPart& one) { return one.name == driven.robot; });
  if (part == robots.robots.end()) fail("is of no robot of the scene");
  std::set<std::string, std::less<>> names;
  for (const robot::Joint& joint : part->model->joints) names.insert(joint.name);
  const int joint = part->model->find_joint(driven.joint);
  if (joint < 0) fail("is no joint of that robot; " + suggestion(driven.joint, names));
  if (part->model->joints[static_cast<std::size_t>(joint)].mimic) fail("follows another joint and cannot be driven");
}
}  // namespace

Replay read_replay(const SceneFile& file) {
  Replay replay;
  replay.name = file["episode"].text();
  replay.scene = named_file(file["scene"], file.path(), "scenes");
  replay.episode = read_episode(named_file(file["recording"], file.path(), "episodes"));
  file.root().read(replay.params);
  replay.camera = read_camera(file, replay.episode);
  const auto [first, last] = replay.episode.common();
  replay.start = file["start"].number_or(first, Range::closed(first, last), "s");
  replay.joints = read_joints(file["joints"], replay.episode);
  file.require_all_used();
  return replay;
}

void add_motions(const Replay& replay, RobotScene& robots) {
  for (const DrivenJoint& driven : replay.joints) require_driveable(driven, robots);
  for (RobotPart& part : robots.robots) {
    for (const MotionStream& stream : replay.episode.streams) {
      robot::JointTrajectory motion = trajectory_of(replay, stream, part);
      if (motion.joints.empty()) continue;
      const robot::VecX start = motion.at(0).q;
      for (std::size_t j = 0; j < motion.joints.size(); ++j)
        part.start[part.model->find_joint(motion.joints[j])] = start[static_cast<Eigen::Index>(j)];
      part.motions.push_back({[motion](const robot::VecX&) { return motion; }, motion.start(), motion.end() - motion.start()});
    }
    const robot::JointMap map = joint_map(*part.model);
    part.start = map.all(map.independent_of(part.start));  // joints that follow others start with them
  }
}
}  // namespace cosim
