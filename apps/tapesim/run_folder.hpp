#pragma once
#include <filesystem>
#include <optional>
#include <string>

#include "apps/movie/live_movie.hpp"
#include "cosim/run/new_file.hpp"
#include "cosim/run/run_log.hpp"
#include "cosim/run/state_file.hpp"

namespace tape::tapesim {
/// The files of a run: steps.csv, state.h5 and snapshot.h5 in one folder. They appear under their names when the run ends. A run that
/// was resumed into the folder it came from keeps what was written there up to the step it goes on from.
class RunFolder {
 public:
  /// @param pictures  what the scene says of pictures, for those made later  @throws InputError where the folder cannot be written in
  RunFolder(std::filesystem::path folder, const World& world, const cosim::RobotScene& robots, const std::vector<cosim::Phase>& phases,
            const State& start, const std::string& pictures);
  /// From now on this movie gets what is recorded, too. To be given before the first state; it must outlive this.
  void show(movie::LiveMovie& movie);
  /// A strip was cut.
  void start_mesh();
  void add_step(const cosim::StepRow& row);
  /// The end of the step that was added last, or the start.
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
  std::vector<cosim::Phase> phases_;
  std::string pictures_;
  cosim::TextFile steps_;
  std::optional<cosim::StateWriter> states_;
  movie::LiveMovie* movie_ = nullptr;
  int mesh_ = 0;                  // how often strips have been cut since this began
  std::vector<Vec3> grip_force_;  // [grips] N at the end of the last step
  int last_recorded_ = -1;        // step
};
}  // namespace tape::tapesim
