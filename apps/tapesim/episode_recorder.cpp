#include "apps/tapesim/episode_recorder.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include "cosim/episode/episode_file.hpp"
#include "cosim/episode/replay_file.hpp"
#include "cosim/run/new_file.hpp"
#include "cosim/run/state_file.hpp"
#include "tape/math/rotation.hpp"

namespace tape::tapesim {
namespace {
namespace fs = std::filesystem;
constexpr Real kResolution = 1e-6;  // [rad or m] of recorded positions
constexpr Real kVisible = 0.5;      // [1] share of its rim that a landmark needs

/// FILE without .h5
fs::path stem_of(fs::path file) { return file.extension() == ".h5" ? file.replace_extension() : file; }

std::string origin_of(const SceneArguments& scene) {
  std::string text = fmt::format("synthetic: a simulation of {} by tapesim {}", fs::path(scene.scene).filename().string(), TAPE_VERSION);
  if (!scene.model.empty()) text += ", model " + scene.model;
  for (const std::string& set : scene.overrides) text += ", " + set;
  return text;
}

bool slides(const robot::Joint& joint) { return joint.type == robot::JointType::prismatic; }

cosim::MotionStream stream_of(const cosim::RobotPart& part) {
  cosim::MotionStream stream{.name = part.name, .joints = {}, .times = {}};
  for (const robot::Joint& joint : part.model->joints)
    stream.joints.push_back({part.name + ":" + joint.name, slides(joint) ? cosim::Unit::m : cosim::Unit::rad});
  return stream;
}

robot::VecX rounded(const robot::VecX& q) { return (q / kResolution).array().round() * kResolution; }

/// Two independent numbers of a normal distribution, by Box and Muller, the same on every machine.
Vec2 normal(std::mt19937_64& random) {
  const auto uniform = [&] { return (static_cast<Real>(random() >> 11) + 0.5) * 0x1p-53; };
  const Real radius = std::sqrt(-2 * std::log(uniform())), angle = 2 * std::numbers::pi * uniform();
  return radius * Vec2(std::cos(angle), std::sin(angle));
}
}  // namespace

EpisodeRecorder::EpisodeRecorder(const fs::path& file, const SceneArguments& scene, const LoadedWorld& loaded, Stepper& stepper,
                                 const State& start)
    : file_(stem_of(file)),
      scene_(scene),
      params_(loaded.input.episode),
      world_(loaded.world),
      stepper_(dynamic_cast<cosim::CoupledStepper*>(&stepper)),
      hub_(loaded.world, "hub"),
      motion_(params_.motion_rate, start.time),
      pictures_(params_.picture_rate, start.time),
      seed_(static_cast<std::uint64_t>(loaded.world.setup.scene.seed)) {
  episode_.name = file_.filename().string();
  cosim::require_writable(file_.string() + ".h5");  // before the work
  episode_.origin = origin_of(scene);
  const auto& robots = loaded.input.run.robots.robots;
  for (std::size_t r = 0; r < robots.size(); ++r) {
    if (robots[r].model->joints.empty()) continue;
    episode_.streams.push_back(stream_of(robots[r]));
    robots_.push_back(static_cast<int>(r));
  }
  if (robots_.empty()) throw InputError("--record: the scene has no robot with joints");
  for (const movie::CameraParams& camera : loaded.input.pictures.cameras) {
    const auto* pinhole = std::get_if<render::PinholeSettings>(&camera.lens);
    if (!pinhole) continue;
    if (std::ranges::find(episode_.cameras, pinhole->name, &cosim::EpisodeCamera::name) != episode_.cameras.end())
      throw InputError("--record: two cameras of the scene are named " + pinhole->name + "; give each its camera.name");
    const cosim::Calibration& c = pinhole->calibration;
    const Pose X_BC{rotation_exp(pinhole->rotation), pinhole->position};
    mounts_.emplace_back(pinhole->mount, world_, loaded.input.run.robots, stepper_);
    episode_.cameras.push_back(
        {.name = pinhole->name, .calibration = c, .mount = pinhole->mount.empty() ? "world" : pinhole->mount, .poses = {X_BC}});
    episode_.landmarks.push_back({.camera = pinhole->name, .body = "hub", .width = c.width, .height = c.height});
  }
  if (mounts_.empty()) throw InputError("--record: the scene has no calibrated camera, one with fx, fy, cx, cy");
  const auto mesh = cosim::RecordedMesh::of(world_, loaded.input.run.robots, loaded.input.run.phases, "", "");
  for (const cosim::RecordedObject& object : mesh.objects) {
    if (object.name == "hub") continue;
    auto& triangles = object.strip ? obstacles_.tapes : obstacles_.bodies;
    triangles.insert(triangles.end(), mesh.triangles.begin() + object.first_triangle,
                     mesh.triangles.begin() + object.first_triangle + object.triangles);
  }
  add_joints(start);
  add_landmarks(start);
}

void EpisodeRecorder::add(const State& state) {
  if (motion_.due(state.time)) add_joints(state);
  if (pictures_.due(state.time)) add_landmarks(state);
}

void EpisodeRecorder::add_joints(const State& state) {
  const std::vector<cosim::RobotRecord> records = stepper_->records(state);
  for (std::size_t s = 0; s < robots_.size(); ++s) {
    const cosim::RobotRecord& record = records[static_cast<std::size_t>(robots_[s])];
    episode_.streams[s].times.push_back(state.time);
    episode_.streams[s].measured.push_back(rounded(record.position));
    episode_.streams[s].commanded.push_back(rounded(record.command));
  }
}

void EpisodeRecorder::add_landmarks(const State& state) {
  obstacles_.x = vertex_positions(world_, state);
  const score::Hub hub = hub_.at(state);
  for (std::size_t c = 0; c < mounts_.size(); ++c) {
    const cosim::Calibration& calibration = episode_.cameras[c].calibration;
    const render::Camera camera = score::camera_at(episode_.cameras[c], state.time, mounts_[c].at(state));
    const score::Sight sight = sight_of(camera, hub, obstacles_);
    cosim::Landmark mark{.time = state.time, .kind = sight.kind, .visible = false};
    if (const auto ideal = hub_landmark(camera, hub, sight.kind); ideal && sight.share >= kVisible) {
      const Vec2 x = calibration.normalized(*ideal);
      std::seed_seq of_picture{seed_, static_cast<std::uint64_t>(state.step), static_cast<std::uint64_t>(c)};
      std::mt19937_64 random(of_picture);
      mark.pixel = calibration.distorted(*ideal) + params_.pixel_noise * normal(random);
      mark.visible = !cosim::folds_before(calibration.lens, x) && calibration.holds(mark.pixel);
      mark.estimated = sight.share < 1;
    }
    episode_.landmarks[c].landmarks.push_back(mark);
  }
}

std::string EpisodeRecorder::replay_text() const {
  const std::string name = file_.filename().string();
  const fs::path folder = fs::absolute(file_).parent_path();
  const bool short_recording = world_.setup.scene.time.duration <= cosim::ReplayParams{}.lead_in;
  std::string text = fmt::format("# {}\nepisode: {}\nscene: {}\nrecording: {}.h5\ncamera: {}\nstart: 0\n{}", episode_.origin, name,
                                 fs::absolute(scene_.scene).lexically_relative(folder).string(), name, episode_.cameras[0].name,
                                 short_recording ? "lead_in: 0\n" : "");
  std::vector<std::string> sets = scene_.overrides;
  if (!scene_.model.empty()) sets.push_back("model=" + scene_.model);
  if (!sets.empty()) text += "set:\n";
  for (const std::string& set : sets) text += fmt::format("  {}: \"{}\"\n", set.substr(0, set.find('=')), set.substr(set.find('=') + 1));
  text += "joints:\n";
  for (std::size_t s = 0; s < robots_.size(); ++s) {
    const cosim::MotionStream& stream = episode_.streams[s];
    const auto& joints = stepper_->robots().robots[static_cast<std::size_t>(robots_[s])].model->joints;
    if (std::ranges::any_of(joints, [](const robot::Joint& joint) { return !joint.mimic && !slides(joint); }))
      text += fmt::format("  \"{0}:*\": {{drives: \"{0}:*\", unit: rad}}\n", stream.name);
    for (std::size_t j = 0; j < joints.size(); ++j) {
      if (joints[j].mimic)
        text += fmt::format("  \"{}\": none\n", stream.joints[j].name);
      else if (slides(joints[j]))
        text += fmt::format("  \"{0}\": {{drives: \"{0}\", unit: m}}\n", stream.joints[j].name);
    }
  }
  return text;
}

void EpisodeRecorder::commit() const {
  const auto with = [&](const char* extension) { return fs::path(file_.string() + extension); };
  cosim::write_episode(with(".h5"), episode_);
  if (!fs::exists(with(".yaml"))) cosim::write_text(with(".yaml"), replay_text());
}
}  // namespace tape::tapesim
