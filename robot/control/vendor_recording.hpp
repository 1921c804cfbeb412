#pragma once
#include <array>

#include "robot/control/trajectory_file.hpp"

namespace robot {
/// How the nine columns X Y Z A B C U V W of a vendor's file are used.
enum class VendorColumns {
  recorded,  ///< X and Y count milliseconds, Z A B C U V W are the joints: what the controller measured (.txt)
  command,   ///< X Y Z A B C U are the joints, V is spare, W marks rows: what it is to do (.fmv)
};

/// Motion in the text files of the Marvin arm's controller, seven joints in degrees, linear between its rows:
///   PoinType=9@1000
///   X 542694.000000$Y 542694.000000$Z 0.001435$A 0.000618$B 0.004436$C -0.002444$U 0.003220$V -0.000371$W 5.021967$
/// the first line with the number of columns and of rows. It starts at t = 0.
/// @param joints   [7] of the model, in the arm's order
/// @param period   [s] between the rows of a command, which hold no time; the controller's own is 1 ms
/// @throws InputError with file, line and column: a first line or a row of another form, a column that is no number, counters that differ
///         or do not increase, a gap, a position beyond the joint's limits, another number of rows than announced
JointTrajectory read_vendor_recording(const std::filesystem::path& file, const RobotModel& model, const std::vector<std::string>& joints,
                                      VendorColumns columns, const TrajectoryFileOptions& options = {}, Real period = 1e-3);
}  // namespace robot
