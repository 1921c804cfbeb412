#pragma once
#include <filesystem>
#include <optional>
#include <string>

#include "cosim/run/new_file.hpp"
#include "cosim/run/run_log.hpp"
#include "cosim/run/state_file.hpp"

namespace tape::tapesim {
/// The files of a run: steps.csv, state.h5 and snapshot.h5 in one folder. They appear under their names when the run ends. A run that
/// was resumed into the folder it came from keeps what was written there up to the step it goes on from.
class RunFolder {
 public:
  /// @param camera  text of the scene's camera, for pictures made later  @throws InputError where the folder cannot be written in
  RunFolder(std::filesystem::path folder, const World& world, const cosim::RobotScene& robots, const State& start,
            const std::string& camera);
  /// A strip was cut.
  void start_mesh();
  void add_step(const cosim::StepRow& row);
  void add_state(const State& state, std::vector<Real> contact_force, std::vector<cosim::RobotRecord> robots);
  /// Gives all files their names, and writes the snapshot.
  void commit(const State& state);
  const std::filesystem::path& path() const { return folder_; }
  std::filesystem::path operator/(const std::string& name) const { return folder_ / name; }

 private:
  cosim::RecordedMesh mesh() const;
  void keep_earlier_steps(const std::string& header, int step);
  bool keep_earlier_states(int step);
  std::filesystem::path folder_;
  const World* world_;
  cosim::RobotScene robots_;
  std::string camera_;
  cosim::TextFile steps_;
  std::optional<cosim::StateWriter> states_;
  int last_recorded_ = -1;  // step
};
}  // namespace tape::tapesim
