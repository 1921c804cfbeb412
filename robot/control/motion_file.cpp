#include "robot/control/motion_file.hpp"

#include <fmt/format.h>

#include <charconv>
#include <cmath>

#include "robot/kinematics/joint_map.hpp"

namespace robot {
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

MotionFile::MotionFile(const std::filesystem::path& file, const RobotModel& model, const std::vector<std::string>& joints,
                       const TrajectoryFileOptions& options)
    : file_(file), model_(model), options_(options), text_(file), result_{joints, {}, {}, JointTrajectory::Between::linear} {
  if (!text_) throw InputError(file.string() + ": cannot be read");
  for (const std::string& name : joints) {
    in_model_.push_back(model.find_joint(name));
    if (in_model_.back() < 0) throw InputError(fmt::format("{}: robot {} has no joint {}", file.string(), model.name, name));
    range_.push_back(joint_range(model, in_model_.back()));
  }
}

bool MotionFile::next_line() {
  while (std::getline(text_, line_)) {
    ++line_number_;
    constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";  // as spreadsheets write it
    if (line_number_ == 1 && line_.starts_with(kByteOrderMark)) line_.erase(0, kByteOrderMark.size());
    const std::string_view line = trimmed(line_);
    if (!line.empty() && line.front() != '#') return true;
  }
  return false;
}

void MotionFile::fail(const std::string& reason) const { throw InputError(fmt::format("{}:{}: {}", file_.string(), line_number_, reason)); }

Real MotionFile::number(const std::string& where, std::string_view text) const {
  if (text.empty()) fail(where + ": is empty");
  Real value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size() || !std::isfinite(value))
    fail(fmt::format("{}: {} is no finite number", where, text));
  return value;
}

void MotionFile::require_within(const std::string& where, Real q, std::size_t j) const {
  const auto [lower, upper] = range_[j];
  if (q < lower - options_.slack || q > upper + options_.slack)
    fail(fmt::format("{}: joint {} = {:g} is beyond its limits (allowed: {:g} to {:g} rad or m)", where, joint(j).name, q, lower, upper));
}

void MotionFile::add(const std::string& where, Real t, const VecX& q) {
  if (!result_.times.empty()) {
    const Real before = result_.end();
    if (t <= before) fail(fmt::format("{}: {:g} s is not after {:g} s", where, t, before));
    if (t - before > options_.max_gap * (1 + 1e-9))
      fail(fmt::format("{}: a gap of {:g} s before {:g} s (allowed: up to {:g} s)", where, t - before, t, options_.max_gap));
  }
  result_.times.push_back(t);
  result_.knots.push_back(q);
}

JointTrajectory MotionFile::finish() {
  if (rows() < 2) throw InputError(fmt::format("{}: has {} rows (allowed: at least 2)", file_.string(), rows()));
  return std::move(result_);
}
}  // namespace robot
