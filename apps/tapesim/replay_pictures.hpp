#pragma once
#include <functional>
#include <list>

#include "apps/movie/stage.hpp"
#include "apps/render/renderer.hpp"
#include "apps/render/text.hpp"
#include "apps/tapesim/hub_watch.hpp"
#include "apps/tapesim/replay_run.hpp"

namespace tape::tapesim {
/// @throws InputError where no pictures can be drawn of an episode: it names no camera, or its first photograph is not of that one
void require_pictures(const cosim::Replay& replay);

/// What the camera of an episode sees, undistorted: of simulated states, and in the photographs that there are.
class EpisodeEye {
 public:
  /// @throws InputError where the episode names no camera
  explicit EpisodeEye(const LoadedReplay& replay);
  /// A simulated state at its time, with the rim of the hub that faces the camera.
  render::Picture simulated(const movie::ViewParams& view, const movie::Stage& stage, const cosim::RecordedMesh& mesh,
                            const cosim::RecordedFrame& frame);
  bool has_photographs() const { return !photographs_.files.empty(); }
  /// The photograph nearest to a time [s] since the start of the replay.
  render::Picture photograph(Real time) const;

 private:
  cosim::EpisodeCamera camera_;
  cosim::Photographs photographs_;
  Real start_;  // [s] on the episode's clock
  HubShape hub_;
  render::Renderer renderer_;
};

/// The start of the simulation as the episode's camera sees it; over the photograph of that time where there is one: what does not stand
/// where it stood shows twice.
render::Picture start_picture(LoadedReplay& replay);

/// Runs of an episode side by side, beside its photographs, with the real and the simulated landmark in each.
class ReplayPictures {
 public:
  explicit ReplayPictures(const LoadedReplay& replay) : eye_(replay) {}
  /// @param folder  with the state.h5 of the run
  void add(const ReplayRun& run, const std::filesystem::path& folder) { columns_.emplace_back(run, folder); }
  /// At the recorded states nearest to a time [s] since the start.
  render::Picture at(Real time);
  /// @param watch  false: no more  @return false if it stopped: there is no file then
  bool write_video(const std::filesystem::path& file, const std::function<bool(int done, int all)>& watch);

 private:
  struct Column {
    Column(const ReplayRun& run, const std::filesystem::path& folder);
    ReplayRun run;
    cosim::StateReader recording;
    movie::PictureParams params;
    movie::Stage stage;
    std::vector<Real> times;  // [s] of the recorded states
  };
  EpisodeEye eye_;
  std::list<Column> columns_;
};
}  // namespace tape::tapesim
