#pragma once
#include <functional>
#include <string>

#include "apps/score/landmark.hpp"
#include "apps/score/statistics.hpp"

namespace tape::score {
/// Index of the state nearest to time t [s]; of two that are equally near the earlier one. No shift in time is fitted.
/// @param times  [n >= 1] s, increasing
std::size_t nearest(const std::vector<Real>& times, Real t);

/// The ideal lens of a recorded camera, where that stands at time t [s] of the episode's clock: the nearest recorded pose counts.
/// @param X_WB  of the link that carries it; of the world the identity
render::Camera camera_at(const cosim::EpisodeCamera& camera, Real t, const Pose& X_WB);

/// One frame that has a visible real landmark.
struct FrameError {
  Real time = 0;          ///< [s] since the start of the replay
  std::size_t state = 0;  ///< simulated state it is compared with
  Real time_offset = 0;   ///< [s] of that state against the frame
  Vec2 real{0, 0};        ///< [px] in the undistorted picture
  Vec2 simulated{0, 0};   ///< [px] likewise; means nothing where `in_front` is off
  cosim::LandmarkKind kind = cosim::LandmarkKind::rim;
  bool estimated = false;                                   ///< the real landmark
  bool in_front = true;                                     ///< off: the hub is not in front of the camera, and there is no error
  Real error() const { return (simulated - real).norm(); }  ///< [px]
};

/// Where the simulated hub is at the recorded states of a run, and what carries the camera.
struct SimulatedHub {
  std::vector<Real> times;        ///< [n] s since the start of the replay, increasing
  std::vector<Hub> states;        ///< [n]
  std::vector<Pose> mounts = {};  ///< [n] X_WB of the link that carries the camera; empty for one that stands in the world
};

/// The real landmarks against the simulated ones of the same kind, frame by frame. Invisible ones are left out, and those before `start` or
/// more than kMaxTimeOffset after the last simulated state.
/// @param camera  of the landmarks; its pose at the nearest recorded time counts
/// @param start   [s] on the episode's clock, at which the simulation's time is 0
/// @throws InputError where a real landmark cannot be undistorted, nothing was simulated, or the poses of the link that carries the camera
/// are
///         missing
std::vector<FrameError> frame_errors(const cosim::LandmarkTrack& real, const cosim::EpisodeCamera& camera, const SimulatedHub& simulated,
                                     Real start);

/// One run of an episode.
struct RunScore {
  Real mean_error = 0;         ///< [px] over the frames at and after the lead-in
  int frames = 0;              ///< counted
  int estimated = 0;           ///< of these, frames whose real landmark is estimated
  int not_in_front = 0;        ///< frames after the lead-in without an error
  Real worst_time_offset = 0;  ///< [s] largest distance in time of a counted frame from its simulated state
};
inline constexpr Real kMaxTimeOffset = 0.05;  ///< [s]
/// Whether a frame at this time [s] since the start is counted.
bool counts(Real time, Real lead_in);
/// @param lead_in  [s] frames before it are not counted: nothing moves yet
/// @param max_time_offset  [s] largest distance in time from a frame to its simulated state
/// @throws InputError if no frame is left to count, or one is further from every simulated state: the run did not last as long
RunScore run_score(const std::vector<FrameError>& frames, Real lead_in, Real max_time_offset = kMaxTimeOffset);

/// One frame of an episode, over the runs that repeat it.
struct FrameMean {
  Real time = 0;           ///< [s] since the start of the replay
  Real error = 0;          ///< [px] mean over the runs that have one
  bool estimated = false;  ///< the real landmark
};
/// Runs that repeat an episode, joined by the times of their frames: one may lack an error where others have one.
std::vector<FrameMean> mean_errors(const std::vector<std::vector<FrameError>>& runs);

/// Mean errors [px] of one model: for each episode the runs that repeat it.
struct ModelErrors {
  std::string model;
  std::vector<std::vector<Real>> runs;  ///< [episodes][repeats]
};
struct ModelScore {
  std::string model;
  std::vector<Real> episodes;  ///< [px] mean over the repeats of each
  Real mean = 0;               ///< [px] over the episodes, each counting the same
  Interval interval;           ///< [px] bootstrap over the episodes
};
/// @throws InputError if an episode has no run
ModelScore model_score(const ModelErrors& errors, const BootstrapParams& params = {});

/// What a model takes off the mean error of another over the same episodes.
struct Reduction {
  Real share = 0;     ///< [1] 1 - mean / mean of the baseline
  Interval interval;  ///< [1] bootstrap over the episodes, drawn for both together
};
/// @throws InputError unless both have the same number of episodes
Reduction reduction(const ModelScore& model, const ModelScore& baseline, const BootstrapParams& params = {});
}  // namespace tape::score
