#pragma once
#include <filesystem>

#include "cosim/episode/episode.hpp"
#include "robot/control/vendor_recording.hpp"

/// Recordings of others, made into parts of an episode. What is refused is an InputError with file, line and column.
namespace cosim {
/// A joint of a table: the columns that hold it, by their names in the header; empty: not recorded.
struct TableJoint {
  std::string name;
  Unit unit = Unit::rad;
  std::string measured = {}, commanded = {};
};
/// Rows of comma-separated numbers under a header of plain names; lines that start with # and other columns are skipped.
/// @param time  name of the column of times [s]
MotionStream import_csv(const std::filesystem::path& file, const std::string& stream, const std::string& time,
                        const std::vector<TableJoint>& joints);

/// Units of the joints of a LeRobot data set, which says nothing about them.
struct LeRobotUnits {
  Unit usual = Unit::rad;
  std::vector<std::pair<std::string, Unit>> of = {};  ///< joints that differ; a * stands for any text, later ones override earlier ones
};
/// An episode of a LeRobot data set, version 2.1: meta/info.json and meta/episodes.jsonl of its folder, and the episode's table as CSV with
/// columns timestamp [s], state.<joint> (observation.state, measured) and action.<joint> (commanded), if the set has it. README.md says how
/// Parquet becomes CSV.
MotionStream import_lerobot(const std::filesystem::path& folder, int episode, const std::filesystem::path& table,
                            const LeRobotUnits& units);

/// A text file of the Marvin arm's controller (robot/control/vendor_recording.hpp); joints of the model [rad], within its limits. What the
/// controller recorded is measured, what it was to do is commanded.
/// @param period  [s] between rows of a command
MotionStream import_vendor(const std::filesystem::path& file, const std::string& stream, const robot::RobotModel& model,
                           const std::vector<std::string>& joints, robot::VendorColumns columns, Real period = 1e-3);

/// Landmarks from comma-separated rows under the header
///   time_s, u [px], v [px], kind, visible, estimated
/// where kind is rim or side_box, and visible and estimated are 1 or 0; u and v may be empty where nothing is visible.
/// @param track  of which the landmarks are replaced
LandmarkTrack import_landmarks(const std::filesystem::path& file, LandmarkTrack track);
}  // namespace cosim
