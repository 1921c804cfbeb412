#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "apps/score/score.hpp"
#include "apps/tapesim/recorded_run.hpp"
#include "apps/tapesim/run_store.hpp"
#include "cosim/episode/replay_file.hpp"

namespace tape::tapesim {
/// A scene whose robots move as recorded.
struct LoadedReplay {
  cosim::Replay replay;
  SceneArguments scene;
  LoadedWorld loaded;

  std::string model() const;  ///< by its name; "none" where the scene has none
  /// The landmarks that it is scored by; null: it is not scored.
  const cosim::LandmarkTrack* landmarks() const;
};
/// @param model  "": that of the scene  @param overrides  of keys of the scene, after those of the episode
/// @throws InputError for whatever is wrong with the episode, the scene or both together
LoadedReplay load_replay(const std::filesystem::path& episode, const std::string& model, const std::vector<std::string>& overrides);

/// What came of one run.
struct ReplayRun : RunCost {
  std::string episode, model;
  int repeat = 1;
  Real simulated = 0;  ///< [s]
  std::string state_hash{};
  std::vector<score::FrameError> frames{};  ///< with a visible landmark; none where the episode is not scored
  score::RunScore score{};                  ///< means nothing without frames
};
/// Of all that decides the outcome of a run.
std::string key_of(const LoadedReplay& replay, int repeat, Backend backend);
bool find(const RunStore& store, const std::string& key, const cosim::Replay& replay, ReplayRun& run);
void keep(const RunStore& store, const std::string& key, const ReplayRun& run);

/// Simulates into a folder: the files of a run, and errors.csv with one row a frame. A numerical failure is a result.
/// @param record  FILE.h5 that the run becomes an episode in, too; empty: none
/// @param run  of which episode, model and repeat are set
/// @return false if interrupted
bool simulate_replay(LoadedReplay& replay, const std::filesystem::path& folder, const std::string& record, Backend backend,
                     const OnStep& on_step, ReplayRun& run);
}  // namespace tape::tapesim
