#pragma once
#include <filesystem>

#include "robot/control/trajectory.hpp"

namespace robot {
/// What a file of joint positions may hold.
struct TrajectoryFileOptions {
  Real max_gap = 0.1;  ///< [s] between two rows
  Real slack = 0.02;   ///< [rad or m] beyond a joint's limits: recorded motion is noisy
};

/// A recorded or commanded motion, linear between its rows. The file is comma-separated, its first line the header
///   time_s, shoulder [deg], elbow [rad], slide [m]
/// with the unit of each column, rad or deg where the joint turns and m where it slides; empty lines and lines that start with # are
/// skipped.
/// @param joints  names that the file must have, each once, in any order; the result has them in this order
/// @throws InputError with file, line and column: an unknown, missing or repeated joint, a wrong unit, a cell that is empty or no number,
///         time that does not increase or has a gap, a position beyond the joint's limits, less than two rows
JointTrajectory read_trajectory(const std::filesystem::path& file, const RobotModel& model, const std::vector<std::string>& joints,
                                const TrajectoryFileOptions& options = {});

/// Names of the joints that such a file's header has.  @throws InputError if it has none
std::vector<std::string> joints_in_header(const std::filesystem::path& file);

/// A joint that a column of somebody else's file drives: q = scale * value + offset.
struct DrivenByColumn {
  std::string joint;   ///< of the model
  std::string column;  ///< as the file's header has it
  Real scale = 1;      ///< [rad or m per unit of the column] with the sign of the joint's axis against the other's
  Real offset = 0;     ///< [rad or m]
};

/// The same from a comma-separated file with a header of plain names, recorded on another robot. Columns that drive no joint are not read.
/// @param time  name of the column of times [s]
/// @throws InputError with file, line and column, as read_trajectory
JointTrajectory read_table(const std::filesystem::path& file, const RobotModel& model, const std::string& time,
                           const std::vector<DrivenByColumn>& joints, const TrajectoryFileOptions& options = {});
}  // namespace robot
