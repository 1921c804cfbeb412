#pragma once
#include <filesystem>
#include <fstream>
#include <string_view>

#include "robot/control/trajectory_file.hpp"

namespace robot {
std::string_view trimmed(std::string_view text);
/// The parts of a line between its commas, trimmed.
std::vector<std::string_view> cells_of(std::string_view line);

/// Joint positions over time while their file is read line by line: what all formats have in common.
class MotionFile {
 public:
  /// @throws InputError if the file cannot be read, or the model has no joint of a name
  MotionFile(const std::filesystem::path& file, const RobotModel& model, const std::vector<std::string>& joints,
             const TrajectoryFileOptions& options);

  const std::vector<std::string>& names() const { return result_.joints; }
  const Joint& joint(std::size_t j) const { return model_.joints[static_cast<std::size_t>(in_model_[j])]; }
  std::size_t rows() const { return result_.times.size(); }

  /// The next line that is not empty and does not start with #.
  bool next_line();
  const std::string& line() const { return line_; }

  [[noreturn]] void fail(const std::string& reason) const;  ///< in this line
  /// @param where  in the line
  Real number(const std::string& where, std::string_view text) const;
  void require_within(const std::string& where, Real q, std::size_t joint) const;
  /// @param where  in the line the time stands
  void add(const std::string& where, Real t, const VecX& q);
  /// @throws InputError if there are less than two rows
  JointTrajectory finish();

 private:
  std::filesystem::path file_;
  const RobotModel& model_;
  TrajectoryFileOptions options_;
  std::ifstream text_;
  std::string line_;
  int line_number_ = 0;
  std::vector<int> in_model_;                 // [joints]
  std::vector<std::pair<Real, Real>> range_;  // [joints] rad or m
  JointTrajectory result_;
};
}  // namespace robot
