#pragma once
#include <filesystem>
#include <optional>
#include <vector>

#include "apps/score/visibility.hpp"
#include "apps/tapesim/hub_watch.hpp"
#include "apps/tapesim/scene_input.hpp"
#include "cosim/episode/episode.hpp"
#include "cosim/run/record_clock.hpp"

namespace tape::tapesim {
/// A simulation that plays the real world: writes the motion of its robots, and what its calibrated cameras see of the hub, as a
/// synthetic episode. The first joint positions and pictures are those of the start; positions are rounded to 1e-6 rad or m.
/// A landmark is visible if less than half of its rim is hidden, estimated if any part is (visibility.hpp).
class EpisodeRecorder {
 public:
  /// @param file  FILE.h5  @throws InputError if there is no robot with joints, no calibrated camera or no hub
  EpisodeRecorder(const std::filesystem::path& file, const SceneArguments& scene, const LoadedWorld& loaded, Stepper& stepper,
                  const State& start);
  void add(const State& state);  ///< after each step
  /// Writes FILE.h5, and FILE.yaml to replay it unless there is one.
  void commit() const;

 private:
  void add_joints(const State& state);
  void add_landmarks(const State& state);
  std::string replay_text() const;

  std::filesystem::path file_;
  SceneArguments scene_;
  EpisodeParams params_;
  const World& world_;
  cosim::CoupledStepper* stepper_;
  HubShape hub_;
  cosim::Episode episode_;
  std::vector<int> robots_;    // [streams]
  std::vector<Mount> mounts_;  // [cameras]
  score::Obstacles obstacles_;
  cosim::RecordClock motion_, pictures_;
  std::uint64_t seed_;
};
}  // namespace tape::tapesim
