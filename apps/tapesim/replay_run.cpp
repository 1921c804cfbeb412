#include "apps/tapesim/replay_run.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "apps/report/table.hpp"
#include "apps/tapesim/episode_recorder.hpp"
#include "apps/tapesim/hub_watch.hpp"
#include "cosim/exchange/exchange.hpp"
#include "cosim/run/new_file.hpp"
#include "cosim/scene/folder_name.hpp"
#include "cosim/scene/scene_file.hpp"
#include "tape/core/execution.hpp"
#include "tape/core/hash.hpp"

namespace tape::tapesim {
namespace {
using Json = RunStore::Json;

std::string calibration_text(const cosim::Calibration& c) {
  const cosim::Distortion& d = c.lens;
  return fmt::format("{} {} {} {} {} {} {} {} {} {} {}", c.fx, c.fy, c.cx, c.cy, c.width, c.height, d.k1, d.k2, d.p1, d.p2, d.k3);
}

template <class T>
void add_numbers(Hash& hash, const T& numbers) {
  hash.add(numbers.data(), static_cast<std::size_t>(numbers.size()) * sizeof numbers[0]);
}
/// What was recorded, and what its numbers mean, whatever file it comes from.
void add(Hash& hash, const cosim::Episode& episode) {
  for (const cosim::MotionStream& stream : episode.streams) {
    for (const cosim::RecordedJoint& joint : stream.joints) hash.add(joint.name + ' ' + to_text(joint.unit) + '\n');
    add_numbers(hash, stream.times);
    for (const auto* rows : {&stream.measured, &stream.commanded}) {
      hash.add(fmt::format("{}\n", rows->size()));
      for (const robot::VecX& row : *rows) add_numbers(hash, row);
    }
  }
  for (const cosim::EpisodeCamera& camera : episode.cameras) {
    hash.add(fmt::format("{} {} {}\n", camera.name, camera.mount, calibration_text(camera.calibration)));
    add_numbers(hash, camera.times);
    for (const Pose& pose : camera.poses) add_numbers(hash, pose.rotation.reshaped()), add_numbers(hash, pose.position);
  }
  for (const cosim::LandmarkTrack& track : episode.landmarks) {
    hash.add(fmt::format("{} {} {} {} {}\n", track.camera, track.body, track.width, track.height, track.undistorted));
    for (const cosim::Landmark& m : track.landmarks)
      hash.add(fmt::format("{} {} {} {} {} {}\n", m.time, m.pixel.x(), m.pixel.y(), to_text(m.kind), m.visible, m.estimated));
  }
}

void score_frames(const cosim::Replay& replay, ReplayRun& run) {
  if (!run.frames.empty()) run.score = score::run_score(run.frames, replay.params.lead_in);
}

/// One row a frame.
std::string errors_csv(const cosim::Replay& replay, const ReplayRun& run) {
  report::Table table{{"time_s", "state_offset_s", "kind", "estimated", "real_u_px", "real_v_px", "simulated_u_px", "simulated_v_px",
                       "error_px", "counted", "data"},
                      {}};
  for (const score::FrameError& f : run.frames) {
    const auto simulated = [&](Real value) { return f.in_front ? to_text(value) : std::string(); };
    table.rows.push_back({to_text(f.time), to_text(f.time_offset), to_text(f.kind), f.estimated ? "1" : "0", to_text(f.real.x()),
                          to_text(f.real.y()), simulated(f.simulated.x()), simulated(f.simulated.y()), simulated(f.error()),
                          f.in_front && score::counts(f.time, replay.params.lead_in) ? "1" : "0",
                          replay.episode.synthetic() ? "synthetic" : "recorded"});
  }
  return report::to_csv(table);
}
}  // namespace

std::string LoadedReplay::model() const {
  const auto& model = loaded.world.setup.scene.model;
  return model ? to_text(*model) : "none";
}

const cosim::LandmarkTrack* LoadedReplay::landmarks() const {
  for (const cosim::LandmarkTrack& track : replay.episode.landmarks)
    if (track.camera == replay.camera) return &track;
  return nullptr;
}

LoadedReplay load_replay(const std::filesystem::path& episode, const std::string& model, const std::vector<std::string>& overrides) {
  const cosim::SceneFile file = cosim::SceneFile::load(episode);
  cosim::Replay replay = cosim::read_replay(file);
  cosim::require_folder_name(file["episode"], replay.name);
  SceneArguments scene{.scene = replay.scene.string(), .overrides = replay.overrides, .model = model};
  scene.overrides.insert(scene.overrides.end(), overrides.begin(), overrides.end());
  LoadedWorld loaded = load_world(scene, Rolls::settle, [&](cosim::RunInput& input) { cosim::set_up(replay, input); });
  LoadedReplay result{std::move(replay), std::move(scene), std::move(loaded)};
  if (result.replay.camera.empty()) return result;
  const cosim::LandmarkTrack* track = result.landmarks();
  if (!track) file["camera"].fail("has no landmarks in the recording; without a camera the episode is replayed and not scored");
  const Scene& setup = result.loaded.world.setup.scene;
  const Real start = result.replay.start, lead_in = result.replay.params.lead_in, between = setup.time.dt;
  const Real end = cosim::planned_steps(setup) * between + score::kMaxTimeOffset;
  const auto counts = [&](const cosim::Landmark& mark) {
    return mark.visible && score::counts(mark.time - start, lead_in) && mark.time - start <= end;
  };
  if (std::ranges::none_of(track->landmarks, counts))
    file["lead_in"].fail(
        fmt::format("no landmark is visible from {:g} s of the recording on, where it ends, to the end of the motions "
                    "(allowed: at least one)",
                    start + lead_in));
  const cosim::EpisodeCamera& camera = result.replay.episode.camera(result.replay.camera, result.replay.name);
  for (const cosim::Landmark& mark : track->landmarks) {
    if (!mark.visible || track->undistorted) continue;
    try {
      (void)camera.calibration.undistorted(mark.pixel);
    } catch (const InputError& e) {
      file["recording"].fail(fmt::format("the landmark of camera {} at {:g} s: {}", camera.name, mark.time, e.what()));
    }
  }
  if (between > 2 * score::kMaxTimeOffset)
    file["scene"].fail(
        fmt::format("has a state each {:g} s (time.dt); landmarks are scored by one within {:g} s", between, score::kMaxTimeOffset));
  try {
    HubShape(result.loaded.world, track->body);
    Mount(camera.mount, result.loaded.world, result.loaded.input.run.robots, nullptr);
  } catch (const InputError& e) {
    file["scene"].fail(e.what());
  }
  return result;
}

std::string key_of(const LoadedReplay& replay, int repeat, Backend backend) {
  const cosim::Replay& r = replay.replay;
  Hash hash;
  hash.add(fmt::format("{} {} {} {}\n", repeat, replay.model(), r.start, r.camera));
  hash.add_file(r.scene);
  hash.add(fmt::format("{}\n", fmt::join(replay.scene.overrides, "\n")));
  for (const cosim::DrivenJoint& joint : r.joints)
    hash.add(fmt::format("{} {} {} {} {} {} {}\n", joint.recorded, joint.robot, joint.joint, joint.sign, joint.scale, joint.offset,
                         to_text(joint.follow)));
  add(hash, r.episode);
  add_run(hash, replay.loaded, State::start(replay.loaded.world), backend);
  return hash.text();
}

bool find(const RunStore& store, const std::string& key, const cosim::Replay& replay, ReplayRun& run) {
  return store.find(key, [&](const Json& j) {
    ReplayRun found = run;
    RunStore::read(j, found);
    found.simulated = j.at("simulated_s"), found.state_hash = j.at("state_hash");
    for (const Json& f : j.at("frames"))
      found.frames.push_back({.time = f.at(0),
                              .state = f.at(1),
                              .time_offset = f.at(2),
                              .real{f.at(3).get<Real>(), f.at(4).get<Real>()},
                              .simulated{f.at(5).get<Real>(), f.at(6).get<Real>()},
                              .kind = static_cast<cosim::LandmarkKind>(f.at(7).get<int>()),
                              .estimated = f.at(8),
                              .in_front = f.at(9)});
    score_frames(replay, found);
    run = std::move(found);
  });
}

void keep(const RunStore& store, const std::string& key, const ReplayRun& run) {
  Json frames = Json::array();
  for (const score::FrameError& f : run.frames)
    frames.push_back({f.time, f.state, f.time_offset, f.real.x(), f.real.y(), f.simulated.x(), f.simulated.y(), static_cast<int>(f.kind),
                      f.estimated, f.in_front});
  Json j{{"episode", run.episode},       {"model", run.model},           {"repeat", run.repeat},
         {"simulated_s", run.simulated}, {"state_hash", run.state_hash}, {"frames", frames}};
  RunStore::write(run, j);
  store.keep(key, j);
}

bool simulate_replay(LoadedReplay& replay, const std::filesystem::path& path, const std::string& record, Backend backend,
                     const OnStep& on_step, ReplayRun& run) {
  LoadedWorld& loaded = replay.loaded;
  const cosim::Replay& episode = replay.replay;
  const std::unique_ptr<Stepper> stepper = cosim::make_stepper(backend, loaded.world, loaded.input.run.robots);
  State state = State::start(loaded.world);
  std::optional<HubWatch> watch;
  if (const cosim::LandmarkTrack* track = replay.landmarks()) {
    const std::string& mount = episode.episode.camera(episode.camera, episode.name).mount;
    watch.emplace(HubShape(loaded.world, track->body),
                  Mount(mount, loaded.world, loaded.input.run.robots, dynamic_cast<const cosim::CoupledStepper*>(stepper.get())));
    watch->add(state);
  }
  std::optional<EpisodeRecorder> recorder;
  if (!record.empty()) recorder.emplace(record, replay.scene, loaded, *stepper, state);
  std::error_code none;
  std::filesystem::remove(path / "errors.csv", none);  // of an earlier run
  RunFolder folder(path, loaded.world, loaded.input.run.robots, loaded.input.run.phases, state,
                   movie::pictures_text(loaded.input.pictures));
  const cosim::RunLog log = simulate_into(folder, loaded, *stepper, state, -1, [&](const State& now, const cosim::StepRow& row) {
    if (watch) watch->add(now);
    if (recorder) recorder->add(now);
    on_step(now, row);
  });
  cosim::RunSummary summary = cosim::summarize(loaded.world, log, loaded.input.run.figures);
  run.take(summary);
  run.simulated = summary.sim_time, run.state_hash = summary.state_hash;
  if (watch && run.failure.empty() && !log.interrupted) {
    run.frames = frame_errors(*replay.landmarks(), episode.episode.camera(episode.camera, episode.name), watch->seen(), episode.start);
    cosim::write_text(folder / "errors.csv", errors_csv(episode, run));
    try {
      score_frames(episode, run);
      summary.figures.emplace_back("mean_error_px", run.score.mean_error);
    } catch (const InputError& e) {  // the hub was never in front of the camera
      run.frames.clear();
      run.failure = e.what();
    }
  }
  commit_run(folder, state, loaded,
             {replay.scene.scene, TAPE_VERSION, runs_on_cuda(backend, replay.loaded.world) ? "cuda" : "cpu", threads(), 0}, summary);
  if (recorder && run.failure.empty() && !log.interrupted) recorder->commit();
  return !log.interrupted;
}
}  // namespace tape::tapesim
