#include "cosim/episode/replay_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <optional>

#include "cosim/episode/camera_file.hpp"
#include "cosim/episode/resample.hpp"
#include "robot/kinematics/joint_map.hpp"

namespace cosim {
namespace {
namespace fs = std::filesystem;

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

/// @param star  what a * in `drives` stands for
/// @param follow  unless the entry says otherwise
DrivenJoint read_driven(const Reader& entry, const std::string& recorded, const std::string& star, Unit unit, Follow follow) {
  const Reader drives = entry["drives"];
  std::string target = drives.text();
  if (const std::size_t at = target.find('*'); at != target.npos) target.replace(at, 1, star);
  const std::size_t colon = target.find(':');
  if (colon == target.npos) drives.fail("names no joint of a robot (allowed: robot:joint)");
  DrivenJoint driven{.recorded = recorded, .robot = target.substr(0, colon), .joint = target.substr(colon + 1), .where = drives.where()};
  const Reader stated = entry["unit"];
  driven.unit = unit;
  if (stated.choice<Unit>() != unit) stated.fail("is recorded in " + tape::to_text(unit) + " (allowed: the same)");
  if (const Reader sign = entry["sign"]) {
    driven.sign = sign.number(Range::closed(-1, 1), "");
    if (std::abs(driven.sign) != 1) sign.fail("is no sign (allowed: 1, -1)");
  }
  const Reader scale = entry["scale"];
  if (unit == Unit::one && !scale) scale.fail("missing; a share moves a joint by a scale in rad or m");
  driven.scale = scale.number_or(1, Range::positive(), "rad or m");
  driven.follow = entry["follow"] ? entry["follow"].choice<Follow>() : follow;
  driven.offset = entry["offset"].number_or(0, Range::closed(-100, 100), "rad or m");
  return driven;
}

/// What the star of a pattern stands for in a name; nothing if the name does not fit. A pattern without a star fits itself.
std::optional<std::string> behind_star(const std::string& pattern, const std::string& name) {
  const std::size_t star = pattern.find('*');
  if (star == pattern.npos) return pattern == name ? std::optional<std::string>("") : std::nullopt;
  const std::string before = pattern.substr(0, star), after = pattern.substr(star + 1);
  if (name.size() < before.size() + after.size() || !name.starts_with(before) || !name.ends_with(after)) return std::nullopt;
  return name.substr(star, name.size() - before.size() - after.size());
}

/// The entry of a recorded joint: of the keys that fit it the last.
struct JointEntry {
  std::string key, star;
};
std::map<std::string, JointEntry> find_entries(const Reader& section, const std::vector<std::string>& names) {
  std::map<std::string, JointEntry> entries;
  for (const std::string& key : section.keys()) {
    bool fits = false;
    for (const std::string& name : names)
      if (const auto star = behind_star(key, name)) entries[name] = {key, *star}, fits = true;
    if (!fits) section[key].fail("the recording has no such joint; " + suggestion(key, {names.begin(), names.end()}));
  }
  for (const std::string& key : section.keys())
    if (std::ranges::none_of(entries, [&](const auto& entry) { return entry.second.key == key; }))
      section[key].fail("moves nothing: entries after it take all its joints");
  return entries;
}

std::vector<DrivenJoint> read_joints(const Reader& section, const Episode& episode, Follow follow) {
  if (!section.is_map()) section.fail("missing; must be a section of recorded joints: {drives: robot:joint, unit: rad}, or none");
  const auto recorded = recorded_joints(episode);
  std::vector<std::string> names;
  for (const auto& [name, place] : recorded) names.push_back(name);
  const std::map<std::string, JointEntry> entries = find_entries(section, names);
  std::vector<DrivenJoint> all;
  for (const auto& [name, place] : recorded) {
    const auto found = entries.find(name);
    if (found == entries.end()) section.fail("recorded joint " + name + " is missing (allowed: what it drives, or none)");
    const Reader entry = section[found->second.key];
    if (!entry.is_map()) {
      if (!entry || entry.text() != "none") entry.fail("must be {drives: robot:joint, unit: ...}, or none where it drives nothing");
      continue;
    }
    const DrivenJoint driven = read_driven(entry, name, found->second.star, place.unit(), follow);
    for (const DrivenJoint& other : all)
      if (other.robot == driven.robot && other.joint == driven.joint) entry["drives"].fail("is driven by " + other.recorded + " already");
    all.push_back(driven);
  }
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

Photographs read_photographs(const SceneFile& file, const std::string& camera) {
  Photographs photographs;
  const Reader section = file["pictures"];
  if (!section) return photographs;
  if (camera.empty()) section.fail("are of no camera: camera is missing");
  section.read(photographs);
  const Reader folder = section["folder"];
  const fs::path beside = fs::absolute(file.path()).parent_path() / folder.text();
  if (!fs::is_directory(beside)) folder.fail("there is no such folder beside this file");
  for (const fs::directory_entry& entry : fs::directory_iterator(beside))
    if (const std::string kind = entry.path().extension(); kind == ".png" || kind == ".jpg" || kind == ".jpeg")
      photographs.files.push_back(entry.path());
  if (photographs.files.empty()) folder.fail("holds no photograph (allowed: .png, .jpg, .jpeg)");
  std::ranges::sort(photographs.files);
  return photographs;
}

/// Knots of the joints of one stream that move one robot.
robot::JointTrajectory trajectory_of(const Replay& replay, const MotionStream& stream, const RobotPart& part) {
  const auto rows = [&](const DrivenJoint& driven) -> const std::vector<robot::VecX>& {
    return driven.follow == Follow::measured ? stream.measured : stream.commanded;
  };
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
  for (const auto& [driven, column] : columns)
    if (rows(*driven).empty())
      throw InputError(fmt::format("{}: motion {} has no {} positions", driven->where, stream.name, tape::to_text(driven->follow)));
  require_no_gap(stream, replay.start, replay.params.max_gap, columns[0].first->where);
  for (std::size_t i = 0; i < stream.times.size(); ++i) {
    robot::VecX q(static_cast<Eigen::Index>(columns.size()));
    for (std::size_t c = 0; c < columns.size(); ++c) {
      const auto& [driven, column] = columns[c];
      const Real recorded = si_per(stream.joints[column].unit) * rows(*driven)[i][static_cast<Eigen::Index>(column)];
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
  const robot::Joint& moved = part->model->joints[static_cast<std::size_t>(joint)];
  if (moved.mimic) fail("follows another joint and cannot be driven");
  const bool slides = moved.type == robot::JointType::prismatic, lengths = driven.unit == Unit::m || driven.unit == Unit::mm;
  if (driven.unit != Unit::one && slides != lengths)
    fail(fmt::format("{} and {} is recorded in {} (allowed: {}, or 1 with a scale)", slides ? "slides," : "turns,", driven.recorded,
                     tape::to_text(driven.unit), slides ? "m, mm" : "rad, deg"));
}
}  // namespace

Replay read_replay(const SceneFile& file) {
  Replay replay;
  replay.name = file["episode"].text();
  replay.scene = named_file(file["scene"], file.path(), "scenes");
  replay.episode = read_recording(file["recording"], file.path());
  const Reader set = file["set"];
  for (const std::string& key : set.keys()) replay.overrides.push_back(key + "=" + set[key].text());
  file.root().read(replay.params);
  replay.camera = read_camera(file, replay.episode);
  replay.photographs = read_photographs(file, replay.camera);
  const auto [first, last] = replay.episode.common();
  if (!(first < last))
    file["recording"].fail(fmt::format("its motions have no time in common: one starts at {:g} s, one ends at {:g} s", first, last));
  replay.start = file["start"].number_or(first, Range::closed(first, last), "s");
  replay.joints = read_joints(file["joints"], replay.episode, replay.params.follow);
  file.require_all_used();
  return replay;
}

void add_motions(const Replay& replay, RobotScene& robots) {
  for (const DrivenJoint& driven : replay.joints) require_driveable(driven, robots);
  for (RobotPart& part : robots.robots) {
    const auto drives_it = [&](const DrivenJoint& driven) { return driven.robot == part.name; };
    if (std::ranges::none_of(replay.joints, drives_it)) continue;
    part.motions.clear();
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

void set_up(const Replay& replay, RunInput& input) {
  add_motions(replay, input.robots);
  place_links(input.robots, input.setup.scene);
  input.setup.scene.time.duration = replay.episode.common().end - replay.start;
}
}  // namespace cosim
