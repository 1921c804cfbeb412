#include "cosim/episode/import.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

#include "robot/control/motion_file.hpp"

namespace cosim {
namespace {
/// Gaps and joints' limits are judged where the motion is used.
constexpr Real kAny = std::numeric_limits<Real>::infinity();
constexpr robot::TrajectoryFileOptions kUnjudged{.max_gap = kAny, .slack = kAny};

/// What the robot's side refuses.
template <class F>
auto translated(const F& f) {
  try {
    return f();
  } catch (const robot::InputError& e) {
    throw InputError(e.what());
  }
}

/// The columns of a table as the joints of a machine without limits, which is how the robot's side reads tables.
robot::JointTrajectory read_columns(const std::filesystem::path& file, const std::string& time, const std::vector<std::string>& columns) {
  robot::RobotModel machine{.name = "table"};
  std::vector<robot::DrivenByColumn> joints;
  for (const std::string& column : columns) {
    robot::Joint joint;
    joint.name = column;
    machine.joints.push_back(joint);
    joints.push_back({.joint = column, .column = column});
  }
  return translated([&] { return robot::read_table(file, machine, time, joints, kUnjudged); });
}

/// The columns of all joints; none if no joint has one.
std::vector<std::string> columns_of(const std::filesystem::path& file, const std::vector<TableJoint>& joints,
                                    std::string TableJoint::*column) {
  std::vector<std::string> columns;
  for (const TableJoint& joint : joints)
    if (!(joint.*column).empty()) columns.push_back(joint.*column);
  if (!columns.empty() && columns.size() != joints.size())
    throw InputError(
        fmt::format("{}: {} of {} joints have such a column (allowed: all or none)", file.string(), columns.size(), joints.size()));
  return columns;
}
}  // namespace

MotionStream import_csv(const std::filesystem::path& file, const std::string& stream, const std::string& time,
                        const std::vector<TableJoint>& joints) {
  MotionStream motion{.name = stream, .joints = {}, .times = {}};
  for (const TableJoint& joint : joints) motion.joints.push_back({joint.name, joint.unit});
  const std::vector<std::string> measured = columns_of(file, joints, &TableJoint::measured),
                                 commanded = columns_of(file, joints, &TableJoint::commanded);
  if (measured.empty() && commanded.empty()) throw InputError(file.string() + ": no column is asked for (allowed: at least one joint)");
  for (const auto& [columns, rows] : {std::pair(&measured, &motion.measured), std::pair(&commanded, &motion.commanded)}) {
    if (columns->empty()) continue;
    robot::JointTrajectory table = read_columns(file, time, *columns);
    motion.times = std::move(table.times);
    *rows = std::move(table.knots);
  }
  return motion;
}

MotionStream import_vendor(const std::filesystem::path& file, const std::string& stream, const robot::RobotModel& model,
                           const std::vector<std::string>& joints, robot::VendorColumns columns, Real period) {
  robot::JointTrajectory recording =
      translated([&] { return robot::read_vendor_recording(file, model, joints, columns, kUnjudged, period); });
  MotionStream motion{.name = stream, .joints = {}, .times = std::move(recording.times)};
  for (const std::string& joint : joints) motion.joints.push_back({joint, Unit::rad});
  (columns == robot::VendorColumns::recorded ? motion.measured : motion.commanded) = std::move(recording.knots);
  return motion;
}

LandmarkTrack import_landmarks(const std::filesystem::path& file, LandmarkTrack track) {
  constexpr std::array<std::string_view, 6> kHeader{"time_s", "u [px]", "v [px]", "kind", "visible", "estimated"};
  constexpr auto kKinds = enum_names(LandmarkKind{});
  track.landmarks.clear();
  translated([&] {
    const robot::RobotModel none;
    robot::MotionFile lines(file, none, {}, {});
    if (!lines.next_line()) throw InputError(file.string() + ": is empty (allowed: a header and rows)");
    const std::vector<std::string_view> header = robot::cells_of(lines.line());
    if (!std::equal(header.begin(), header.end(), kHeader.begin(), kHeader.end()))
      lines.fail(fmt::format("is another header (allowed: {})", fmt::join(kHeader, ", ")));
    while (lines.next_line()) {
      const std::vector<std::string_view> cells = robot::cells_of(lines.line());
      if (cells.size() != kHeader.size()) lines.fail(fmt::format("has {} columns (allowed: {})", cells.size(), kHeader.size()));
      const auto place = [&](std::size_t c) { return fmt::format("column {} ({})", c + 1, kHeader[c]); };
      const auto choice = [&](std::size_t c, std::string_view no, std::string_view yes) {
        if (cells[c] != no && cells[c] != yes) lines.fail(fmt::format("{}: {} (allowed: {}, {})", place(c), cells[c], no, yes));
        return cells[c] == yes;
      };
      Landmark mark{.time = lines.number(place(0), cells[0])};
      mark.kind = static_cast<LandmarkKind>(choice(3, kKinds[0], kKinds[1]));
      mark.visible = choice(4, "0", "1");
      mark.estimated = choice(5, "0", "1");
      if (mark.visible) mark.pixel = {lines.number(place(1), cells[1]), lines.number(place(2), cells[2])};
      track.landmarks.push_back(mark);
    }
  });
  return track;
}
}  // namespace cosim
