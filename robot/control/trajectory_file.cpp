#include "robot/control/trajectory_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <fstream>
#include <numbers>
#include <string_view>

namespace robot {
namespace {
std::string_view trimmed(std::string_view text) {
  constexpr std::string_view kBlanks = " \t\r";
  const auto first = text.find_first_not_of(kBlanks);
  return first == text.npos ? std::string_view() : text.substr(first, text.find_last_not_of(kBlanks) - first + 1);
}
std::vector<std::string_view> cells_of(std::string_view line) {
  std::vector<std::string_view> cells;
  for (std::size_t begin = 0, end = 0; end != line.npos; begin = end + 1) {
    end = line.find(',', begin);
    cells.push_back(trimmed(line.substr(begin, end == line.npos ? end : end - begin)));
  }
  return cells;
}

/// One column after the time.
struct Column {
  std::string name;   ///< as the header has it
  std::size_t joint;  ///< of the joints asked for
  Real unit;          ///< [rad or m]
  Real lower, upper;  ///< [rad or m]
};

class TrajectoryReader {
 public:
  TrajectoryReader(const std::filesystem::path& file, const RobotModel& model, const std::vector<std::string>& joints,
                   const TrajectoryFileOptions& options)
      : file_(file), model_(model), options_(options), text_(file), result_{joints, {}, {}, JointTrajectory::Between::linear} {
    if (!text_) throw InputError(file.string() + ": cannot be read");
  }

  JointTrajectory read() {
    if (!next_line()) throw InputError(file_.string() + ": is empty (allowed: a header and at least two rows)");
    read_header();
    while (next_line()) read_row();
    if (result_.times.size() < 2)
      throw InputError(fmt::format("{}: has {} rows (allowed: at least 2)", file_.string(), result_.times.size()));
    return std::move(result_);
  }

 private:
  /// The next line that says something.
  bool next_line() {
    while (std::getline(text_, line_)) {
      ++line_number_;
      const std::string_view line = trimmed(line_);
      if (!line.empty() && line.front() != '#') return true;
    }
    return false;
  }
  [[noreturn]] void fail(const std::string& reason) const {
    throw InputError(fmt::format("{}:{}: {}", file_.string(), line_number_, reason));
  }
  [[noreturn]] void fail(std::size_t column, std::string_view name, const std::string& reason) const {
    fail(fmt::format("column {} ({}): {}", column + 1, name, reason));
  }

  void read_header() {
    const std::vector<std::string_view> cells = cells_of(line_);
    if (cells.front() != "time_s") fail(0, cells.front(), "the first column is the time (allowed: time_s)");
    for (std::size_t c = 1; c < cells.size(); ++c) columns_.push_back(column_of(c, cells[c]));
    for (std::size_t j = 0; j < result_.joints.size(); ++j)
      if (std::none_of(columns_.begin(), columns_.end(), [j](const Column& column) { return column.joint == j; }))
        fail("joint " + result_.joints[j] + " is missing");
  }
  Column column_of(std::size_t c, std::string_view cell) const {
    const auto open = cell.rfind('[');
    if (open == cell.npos || cell.back() != ']') fail(c, cell, "has no unit (allowed: name [rad], name [deg], name [m])");
    const std::string name(trimmed(cell.substr(0, open)));
    const std::string_view unit = trimmed(cell.substr(open + 1, cell.size() - open - 2));
    const auto joint = std::find(result_.joints.begin(), result_.joints.end(), name);
    const int k = model_.find_joint(name);
    if (joint == result_.joints.end() || k < 0) fail(c, cell, "is no joint that this motion has");
    if (std::any_of(columns_.begin(), columns_.end(), [&](const Column& other) { return other.name == name; }))
      fail(c, cell, "is there twice");
    const Joint& of_model = model_.joints[k];
    const bool slides = of_model.type == JointType::prismatic;
    if (slides ? unit != "m" : unit != "rad" && unit != "deg")
      fail(c, cell, fmt::format("unit {} (allowed: {})", unit, slides ? "m" : "rad, deg"));
    return {name, static_cast<std::size_t>(joint - result_.joints.begin()), unit == "deg" ? std::numbers::pi / 180 : 1, of_model.lower,
            of_model.upper};
  }

  void read_row() {
    const std::vector<std::string_view> cells = cells_of(line_);
    if (cells.size() != columns_.size() + 1) fail(fmt::format("has {} columns, the header {}", cells.size(), columns_.size() + 1));
    const Real t = number(0, "time_s", cells[0]);
    require_next(t);
    VecX q(result_.joints.size());
    for (std::size_t c = 1; c < cells.size(); ++c) {
      const Column& column = columns_[c - 1];
      const Real value = column.unit * number(c, column.name, cells[c]);
      if (value < column.lower - options_.slack || value > column.upper + options_.slack)
        fail(c, column.name,
             fmt::format("{} is beyond the joint's limits (allowed: {:g} to {:g} rad or m)", cells[c], column.lower, column.upper));
      q[column.joint] = value;
    }
    result_.times.push_back(t);
    result_.knots.push_back(q);
  }
  Real number(std::size_t c, std::string_view name, std::string_view cell) const {
    if (cell.empty()) fail(c, name, "is empty");
    Real value = 0;
    const auto [end, error] = std::from_chars(cell.data(), cell.data() + cell.size(), value);
    if (error != std::errc() || end != cell.data() + cell.size() || !std::isfinite(value))
      fail(c, name, fmt::format("{} is no finite number", cell));
    return value;
  }
  void require_next(Real t) const {
    if (result_.times.empty()) return;
    const Real before = result_.end();
    if (t <= before) fail(0, "time_s", fmt::format("{:g} s is not after {:g} s", t, before));
    if (t - before > options_.max_gap * (1 + 1e-9))
      fail(0, "time_s", fmt::format("a gap of {:g} s before {:g} s (allowed: up to {:g} s)", t - before, t, options_.max_gap));
  }

  std::filesystem::path file_;
  const RobotModel& model_;
  TrajectoryFileOptions options_;
  std::ifstream text_;
  std::string line_;
  int line_number_ = 0;
  std::vector<Column> columns_;
  JointTrajectory result_;
};
}  // namespace

JointTrajectory read_trajectory(const std::filesystem::path& file, const RobotModel& model, const std::vector<std::string>& joints,
                                const TrajectoryFileOptions& options) {
  return TrajectoryReader(file, model, joints, options).read();
}
}  // namespace robot
