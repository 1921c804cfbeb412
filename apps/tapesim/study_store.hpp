#pragma once
#include <filesystem>
#include <limits>
#include <string>
#include <vector>

#include "apps/tapesim/run_store.hpp"
#include "apps/tapesim/study_error.hpp"

namespace tape::tapesim {
/// One combination of a study's grid, and what came of it.
struct StudyRun : RunCost {
  std::vector<std::string> values;
  Real error = std::numeric_limits<Real>::quiet_NaN();
  Real turn_error = 0;  ///< [deg] of the hub, where that is measured
  bool finest = false;  ///< others are compared with it
  bool pareto = false;
  Measured measured{};

  bool measurable() const { return failure.empty(); }
};

/// The finished runs of a study.
class StudyStore {
 public:
  explicit StudyStore(std::filesystem::path file) : store_(std::move(file)) {}
  /// Fills in `run` if one with this key is kept. @param key  of all that decides its outcome
  bool find(const std::string& key, StudyRun& run) const;
  void keep(const std::string& key, const StudyRun& run) const;

 private:
  RunStore store_;
};
}  // namespace tape::tapesim
