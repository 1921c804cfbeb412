#include "apps/score/score.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

namespace tape::score {
namespace {
constexpr Real kSameTime = 1e-9;  // [s] frame times are differences of rounded ones
}  // namespace

std::size_t nearest(const std::vector<Real>& times, Real t) {
  TAPE_CHECK(!times.empty());
  const auto after = std::lower_bound(times.begin(), times.end(), t);
  if (after == times.begin()) return 0;
  const auto i = static_cast<std::size_t>(after - times.begin());
  if (after == times.end() || t - times[i - 1] <= times[i] - t) return i - 1;
  return i;
}

render::Camera camera_at(const cosim::EpisodeCamera& camera, Real t, const Pose& X_WB) {
  const Pose& X_BC = camera.poses[camera.times.empty() ? 0 : nearest(camera.times, t)];
  return render::Camera::make(camera.calibration, {X_WB.rotation * X_BC.rotation, apply(X_WB, X_BC.position)});
}

std::vector<FrameError> frame_errors(const cosim::LandmarkTrack& real, const cosim::EpisodeCamera& camera, const SimulatedHub& simulated,
                                     Real start) {
  const std::size_t states = simulated.times.size();
  if (states == 0 || states != simulated.states.size())
    throw InputError("no simulated state to compare landmarks with (allowed: at least one, each with its time)");
  if (simulated.mounts.size() != (camera.mount == "world" ? 0 : states))
    throw InputError(fmt::format("camera {} is carried by {}, whose pose is known at {} of {} states (allowed: at all, none of the world)",
                                 camera.name, camera.mount, simulated.mounts.size(), states));
  std::vector<FrameError> frames;
  for (const cosim::Landmark& mark : real.landmarks) {
    if (!mark.visible || mark.time < start || mark.time - start > simulated.times.back() + kMaxTimeOffset) continue;
    FrameError frame{.time = mark.time - start, .kind = mark.kind, .estimated = mark.estimated};
    frame.state = nearest(simulated.times, frame.time);
    frame.time_offset = simulated.times[frame.state] - frame.time;
    frame.real = real.undistorted ? mark.pixel : camera.calibration.undistorted(mark.pixel);
    const Pose X_WB = simulated.mounts.empty() ? Pose{} : simulated.mounts[frame.state];
    const auto seen = hub_landmark(camera_at(camera, mark.time, X_WB), simulated.states[frame.state], mark.kind);
    frame.in_front = seen.has_value();
    frame.simulated = seen.value_or(Vec2::Zero());
    frames.push_back(frame);
  }
  return frames;
}

bool counts(Real time, Real lead_in) { return time >= lead_in - kSameTime; }

RunScore run_score(const std::vector<FrameError>& frames, Real lead_in, Real max_time_offset) {
  RunScore score;
  std::vector<Real> errors;
  for (const FrameError& frame : frames) {
    if (!counts(frame.time, lead_in)) continue;
    if (!(std::abs(frame.time_offset) <= max_time_offset))
      throw InputError(fmt::format("the landmark at {:g} s is {:g} s from the nearest simulated state (allowed: up to {:g} s)", frame.time,
                                   std::abs(frame.time_offset), max_time_offset));
    if (!frame.in_front) {
      ++score.not_in_front;
      continue;
    }
    errors.push_back(frame.error());
    score.estimated += frame.estimated;
    score.worst_time_offset = std::max(score.worst_time_offset, std::abs(frame.time_offset));
  }
  if (errors.empty())
    throw InputError(fmt::format("no landmark is left to score after the lead-in of {:g} s (allowed: at least one)", lead_in));
  score.frames = static_cast<int>(errors.size());
  score.mean_error = mean(errors);
  return score;
}

std::vector<FrameMean> mean_errors(const std::vector<std::vector<FrameError>>& runs) {
  std::map<Real, std::pair<FrameMean, int>> by_time;
  for (const std::vector<FrameError>& run : runs)
    for (const FrameError& frame : run) {
      if (!frame.in_front) continue;
      auto& [sum, count] = by_time[frame.time];
      sum = {frame.time, sum.error + frame.error(), frame.estimated};
      ++count;
    }
  std::vector<FrameMean> means;
  for (const auto& [time, frame] : by_time) means.push_back({time, frame.first.error / frame.second, frame.first.estimated});
  return means;
}

ModelScore model_score(const ModelErrors& errors, const BootstrapParams& params) {
  ModelScore score{.model = errors.model, .episodes = {}, .interval = {}};
  for (const std::vector<Real>& runs : errors.runs) score.episodes.push_back(mean(runs));
  score.mean = mean(score.episodes);
  score.interval = bootstrap_mean(score.episodes, params);
  return score;
}

Reduction reduction(const ModelScore& model, const ModelScore& baseline, const BootstrapParams& params) {
  if (model.episodes.size() != baseline.episodes.size())
    throw InputError(fmt::format("{} has {} episodes, {} has {} (allowed: the same)", model.model, model.episodes.size(), baseline.model,
                                 baseline.episodes.size()));
  const auto share = [&](const std::vector<int>& drawn) {
    Real of_model = 0, of_baseline = 0;
    for (int i : drawn) {
      of_model += model.episodes[static_cast<std::size_t>(i)];
      of_baseline += baseline.episodes[static_cast<std::size_t>(i)];
    }
    return 1 - of_model / of_baseline;
  };
  return {1 - model.mean / baseline.mean, bootstrap(static_cast<int>(model.episodes.size()), share, params)};
}
}  // namespace tape::score
