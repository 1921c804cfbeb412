#pragma once
#include <filesystem>

#include "robot/control/trajectory.hpp"

namespace robot {
/// What a trajectory file may hold.
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
}  // namespace robot
