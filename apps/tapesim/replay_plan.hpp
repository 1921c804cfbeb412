#pragma once
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "tape/core/types.hpp"

namespace tape::tapesim {
/// Which episodes are replayed with which models, and how often.
struct ReplayPlan {
  std::string name;
  std::vector<std::filesystem::path> episodes;  ///< EPISODE.yaml
  std::vector<std::string> models;              ///< "": that of the scene
  int repeats = 1;
  std::string baseline;                ///< of the models: what reductions count from
  std::vector<std::string> overrides;  ///< of keys of every scene: key=value
  /// Errors [px] that others report, by whom and by model: shown beside ours.
  std::vector<std::pair<std::string, std::map<std::string, Real>>> beside;
};

/// From EPISODE.yaml, or from a file of several:
///   replay: NAME, episodes: [stick_1.yaml, ...], models: [coh-f, ...], repeats: 2, baseline: coh-f, set: {key: value},
///   beside: {paper: {coh-f: 22.96, ...}}
/// @throws InputError "file:line: key = value: reason"
ReplayPlan load_plan(const std::filesystem::path& file);
}  // namespace tape::tapesim
