#include "robot/control/vendor_recording.hpp"

#include <fmt/format.h>

#include <charconv>
#include <numbers>

#include "robot/control/motion_file.hpp"

namespace robot {
namespace {
constexpr std::string_view kNames = "XYZABCUVW";
constexpr std::size_t kJoints = 7;
using Row = std::array<Real, kNames.size()>;

/// Number of rows that the first line announces.
std::size_t announced_rows(MotionFile& file, const std::filesystem::path& name) {
  constexpr std::string_view kStart = "PoinType=9@";
  if (!file.next_line()) throw InputError(name.string() + ": is empty (allowed: a line PoinType=9@rows, and the rows)");
  const std::string_view line = trimmed(file.line());
  std::size_t rows = 0;
  const char* end = line.data() + line.size();
  if (!line.starts_with(kStart) || std::from_chars(line.data() + kStart.size(), end, rows).ptr != end)
    file.fail(fmt::format("{} (allowed: PoinType=9@rows)", line));
  return rows;
}

std::string place(std::size_t column) { return fmt::format("column {} ({})", column + 1, kNames[column]); }

/// "X 1.5$Y -2$...$"
Row row_of(const MotionFile& file) {
  std::string_view rest = trimmed(file.line());
  Row row;
  for (std::size_t c = 0; c < row.size(); ++c) {
    const std::size_t end = rest.find('$');
    if (end == rest.npos || rest[0] != kNames[c]) file.fail(fmt::format("{}: is missing (allowed: {} number$)", place(c), kNames[c]));
    row[c] = file.number(place(c), trimmed(rest.substr(1, end - 1)));
    rest.remove_prefix(end + 1);
  }
  if (!rest.empty()) file.fail(fmt::format("{} after the last column", rest));
  return row;
}
}  // namespace

JointTrajectory read_vendor_recording(const std::filesystem::path& file, const RobotModel& model, const std::vector<std::string>& joints,
                                      VendorColumns columns, const TrajectoryFileOptions& options, Real period) {
  if (joints.size() != kJoints)
    throw InputError(fmt::format("{}: {} joints asked for (allowed: {})", file.string(), joints.size(), kJoints));
  if (!(period > 0)) throw InputError(fmt::format("{}: period = {:g} s (allowed: > 0)", file.string(), period));
  const bool recorded = columns == VendorColumns::recorded;
  const std::size_t first = recorded ? 2 : 0;
  MotionFile motion(file, model, joints, options);
  const std::size_t announced = announced_rows(motion, file);
  Real start = 0;  // [ms]
  while (motion.next_line()) {
    const Row row = row_of(motion);
    if (recorded && row[0] != row[1]) motion.fail(fmt::format("{}: {} differs from {} of X", place(1), row[1], row[0]));
    if (motion.rows() == 0) start = row[0];
    VecX q(kJoints);
    for (std::size_t j = 0; j < kJoints; ++j) {
      q[j] = std::numbers::pi / 180 * row[first + j];
      motion.require_within(place(first + j), q[j], j);
    }
    motion.add(place(0), recorded ? 1e-3 * (row[0] - start) : period * static_cast<Real>(motion.rows()), q);
  }
  if (motion.rows() != announced)
    throw InputError(fmt::format("{}: has {} rows (allowed: {}, as its first line says)", file.string(), motion.rows(), announced));
  return motion.finish();
}
}  // namespace robot
