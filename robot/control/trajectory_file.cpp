#include "robot/control/trajectory_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <numbers>

#include "robot/control/motion_file.hpp"

namespace robot {
namespace {
std::string place(std::size_t cell, std::string_view name) { return fmt::format("column {} ({})", cell + 1, name); }

/// Where the position of a joint stands, and in which unit: q = scale * value + offset.
struct Column {
  std::string name;   ///< as the header has it
  std::size_t cell;   ///< of the line
  std::size_t joint;  ///< of the joints asked for
  Real scale, offset;
};

/// The columns of a file, after its header has been read.
struct Table {
  std::size_t cells;  ///< of each line
  std::string time;   ///< name of its column
  std::size_t time_cell;
  std::vector<Column> columns;
};

JointTrajectory read_rows(MotionFile& file, const Table& table) {
  while (file.next_line()) {
    const std::vector<std::string_view> cells = cells_of(file.line());
    if (cells.size() != table.cells) file.fail(fmt::format("has {} columns, the header {}", cells.size(), table.cells));
    const std::string time = place(table.time_cell, table.time);
    const Real t = file.number(time, cells[table.time_cell]);
    VecX q(file.names().size());
    for (const Column& column : table.columns) {
      const std::string where = place(column.cell, column.name);
      q[column.joint] = column.scale * file.number(where, cells[column.cell]) + column.offset;
      file.require_within(where, q[column.joint], column.joint);
    }
    file.add(time, t, q);
  }
  return file.finish();
}

void read_header_line(MotionFile& file, const std::filesystem::path& name) {
  if (!file.next_line()) throw InputError(name.string() + ": is empty (allowed: a header and at least two rows)");
}

/// Of a header's cell: name [unit].
Column column_of(const MotionFile& file, std::size_t c, std::string_view cell, const std::vector<Column>& before) {
  const auto fail = [&](const std::string& reason) { file.fail(place(c, cell) + ": " + reason); };
  const auto open = cell.rfind('[');
  if (open == cell.npos || cell.back() != ']') fail("has no unit (allowed: name [rad], name [deg], name [m])");
  const std::string name(trimmed(cell.substr(0, open)));
  const std::string_view unit = trimmed(cell.substr(open + 1, cell.size() - open - 2));
  const auto joint = std::find(file.names().begin(), file.names().end(), name);
  if (joint == file.names().end()) fail("is no joint that this motion has");
  if (std::any_of(before.begin(), before.end(), [&](const Column& other) { return other.name == name; })) fail("is there twice");
  const auto j = static_cast<std::size_t>(joint - file.names().begin());
  const bool slides = file.joint(j).type == JointType::prismatic;
  if (slides ? unit != "m" : unit != "rad" && unit != "deg") fail(fmt::format("unit {} (allowed: {})", unit, slides ? "m" : "rad, deg"));
  return {name, c, j, unit == "deg" ? std::numbers::pi / 180 : 1, 0};
}
}  // namespace

JointTrajectory read_trajectory(const std::filesystem::path& file, const RobotModel& model, const std::vector<std::string>& joints,
                                const TrajectoryFileOptions& options) {
  MotionFile motion(file, model, joints, options);
  read_header_line(motion, file);
  const std::vector<std::string_view> cells = cells_of(motion.line());
  if (cells.front() != "time_s") motion.fail(place(0, cells.front()) + ": the first column is the time (allowed: time_s)");
  Table table{cells.size(), "time_s", 0, {}};
  for (std::size_t c = 1; c < cells.size(); ++c) table.columns.push_back(column_of(motion, c, cells[c], table.columns));
  for (std::size_t j = 0; j < joints.size(); ++j)
    if (std::none_of(table.columns.begin(), table.columns.end(), [j](const Column& column) { return column.joint == j; }))
      motion.fail("joint " + joints[j] + " is missing");
  return read_rows(motion, table);
}

std::vector<std::string> joints_in_header(const std::filesystem::path& file) {
  const RobotModel none;
  MotionFile motion(file, none, {}, {});
  read_header_line(motion, file);
  std::vector<std::string> names;
  for (const std::string_view cell : cells_of(motion.line()))
    if (cell != "time_s") names.emplace_back(trimmed(cell.substr(0, cell.rfind('['))));
  if (names.empty()) motion.fail("the header names no joint");
  return names;
}

JointTrajectory read_table(const std::filesystem::path& file, const RobotModel& model, const std::string& time,
                           const std::vector<DrivenByColumn>& joints, const TrajectoryFileOptions& options) {
  std::vector<std::string> names;
  for (const DrivenByColumn& driven : joints) names.push_back(driven.joint);
  MotionFile motion(file, model, names, options);
  read_header_line(motion, file);
  const std::vector<std::string_view> cells = cells_of(motion.line());
  const auto cell_of = [&](const std::string& name) {
    const auto found = std::find(cells.begin(), cells.end(), name);
    if (found == cells.end()) motion.fail("column " + name + " is missing");
    if (std::find(found + 1, cells.end(), name) != cells.end()) motion.fail("column " + name + " is there twice");
    return static_cast<std::size_t>(found - cells.begin());
  };
  Table table{cells.size(), time, cell_of(time), {}};
  for (std::size_t j = 0; j < joints.size(); ++j)
    table.columns.push_back({joints[j].column, cell_of(joints[j].column), j, joints[j].scale, joints[j].offset});
  return read_rows(motion, table);
}
}  // namespace robot
