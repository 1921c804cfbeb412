#pragma once
#include <string>
#include <vector>

#include "apps/render/chart.hpp"
#include "cosim/run/state_file.hpp"

namespace tape::movie {
using cosim::RecordedFrame, cosim::RecordedMesh;

/// What has happened in a motion so far, in words and figures for its pictures.
class Chronicle {
 public:
  /// @param bearers  whose force is told (force_on)
  explicit Chronicle(const std::vector<std::string>& bearers);
  /// The next state.
  void add(const RecordedMesh& mesh, const RecordedFrame& frame);
  const std::string& caption() const { return caption_; }               ///< scene, time and phase
  bool just_cut() const;                                                ///< in the last moment a strip was cut
  const std::vector<render::Chart>& charts() const { return charts_; }  ///< [bearers] force over the last seconds

 private:
  std::vector<render::Chart> charts_;  // with all samples
  std::string caption_;
  Real time_ = 0, cut_;  // [s] of the last state, and of the last cut
  int mesh_ = 0;         // of the last state
};
}  // namespace tape::movie
