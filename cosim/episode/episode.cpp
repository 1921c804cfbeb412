#include "cosim/episode/episode.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <numbers>
#include <set>

namespace cosim {
namespace {
constexpr Real kTwoTurns = 4 * std::numbers::pi;  // [rad]

struct Bounds {
  Real low, high;
};
/// Between these lies what a joint of a robot can measure; what does not is of another unit.
Bounds plausible(Unit unit) {
  switch (unit) {
    case Unit::rad:
      return {-kTwoTurns, kTwoTurns};
    case Unit::deg:
      return {-720, 720};
    case Unit::m:
      return {-10, 10};
    case Unit::mm:
      return {-10'000, 10'000};
    case Unit::one:
      return {-0.1, 1.1};
  }
  return {};
}

/// Refuses in the name of a part of a file: "episode.h5: motion arm: ...".
struct Judge {
  std::string where;
  template <class... Args>
  void require(bool condition, fmt::format_string<Args...> text, Args&&... args) const {
    if (!condition) throw InputError(where + ": " + fmt::format(text, std::forward<Args>(args)...));
  }
  Judge part(const std::string& name) const { return {where + ": " + name}; }
};

void judge_times(const Judge& judge, const std::vector<Real>& times) {
  for (std::size_t i = 0; i < times.size(); ++i) {
    judge.require(std::isfinite(times[i]), "time of row {} is {} (allowed: a finite number of s)", i, times[i]);
    judge.require(i == 0 || times[i] > times[i - 1], "time goes from {:g} s to {:g} s in row {} (allowed: it increases)",
                  times[i == 0 ? 0 : i - 1], times[i], i);
  }
}

void judge_values(const Judge& judge, const MotionStream& stream, const std::vector<robot::VecX>& values, const char* what) {
  if (values.empty()) return;
  judge.require(values.size() == stream.times.size(), "{} rows {}, {} times (allowed: the same number)", values.size(), what,
                stream.times.size());
  for (std::size_t i = 0; i < values.size(); ++i) {
    judge.require(static_cast<std::size_t>(values[i].size()) == stream.joints.size(), "row {} {} has {} joints (allowed: {})", i, what,
                  values[i].size(), stream.joints.size());
    for (std::size_t j = 0; j < stream.joints.size(); ++j) {
      const Unit unit = stream.joints[j].unit;
      const Bounds bounds = plausible(unit);
      const Real value = values[i][static_cast<Eigen::Index>(j)];
      judge.require(value >= bounds.low && value <= bounds.high,
                    "joint {} {} = {:g} {} in row {} (allowed: {:g} to {:g} {}; is the unit right?)", stream.joints[j].name, what, value,
                    to_text(unit), i, bounds.low, bounds.high, to_text(unit));
    }
  }
}

void judge_stream(const Judge& judge, const MotionStream& stream, std::set<std::string>& joints) {
  judge.require(!stream.joints.empty(), "has no joint (allowed: at least one)");
  for (const RecordedJoint& joint : stream.joints) {
    judge.require(!joint.name.empty() && joint.name.find(',') == std::string::npos, "joint '{}' (allowed: a name without commas)",
                  joint.name);
    judge.require(joints.insert(joint.name).second, "joint {} is there twice", joint.name);
  }
  judge.require(stream.times.size() >= 2, "has {} rows (allowed: at least 2)", stream.times.size());
  judge_times(judge, stream.times);
  judge.require(!stream.measured.empty() || !stream.commanded.empty(), "has neither measured nor commanded positions");
  judge_values(judge, stream, stream.measured, "measured");
  judge_values(judge, stream, stream.commanded, "commanded");
}

void judge_camera(const Judge& judge, const EpisodeCamera& camera) {
  try {
    require_valid(camera.calibration, "camera");
  } catch (const SettingsError& e) {
    judge.require(false, "{}", e.what());
  }
  const Distortion& d = camera.calibration.lens;
  for (Real k : {d.k1, d.k2, d.p1, d.p2, d.k3}) judge.require(std::isfinite(k), "distortion {} (allowed: finite numbers)", k);
  const std::size_t poses = camera.times.empty() ? 1 : camera.times.size();
  judge.require(camera.poses.size() == poses, "{} poses, {} times (allowed: as many, or one pose without time)", camera.poses.size(),
                camera.times.size());
  judge_times(judge, camera.times);
  for (std::size_t i = 0; i < camera.poses.size(); ++i) {
    const Mat3& R = camera.poses[i].rotation;
    judge.require((R.transpose() * R - Mat3::Identity()).norm() < 1e-6 && R.determinant() > 0, "pose {} has no rotation", i);
    judge.require(camera.poses[i].position.allFinite(), "pose {} has no position", i);
  }
}

void judge_landmarks(const Judge& judge, const LandmarkTrack& track, const Calibration& calibration) {
  require_resolution(calibration, track.width, track.height, judge.where, "the picture of the landmarks");
  std::vector<Real> times;
  for (const Landmark& mark : track.landmarks) times.push_back(mark.time);
  judge_times(judge, times);
  for (const Landmark& mark : track.landmarks)
    judge.require(!mark.visible || calibration.holds(mark.pixel),
                  "landmark at {:g} s is at ({:g}, {:g}) px, outside of the picture (allowed: 0 to {} and 0 to {} px)", mark.time,
                  mark.pixel.x(), mark.pixel.y(), track.width - 1, track.height - 1);
}

Real median_interval(const std::vector<Real>& times) {
  std::vector<Real> intervals;
  for (std::size_t i = 1; i < times.size(); ++i) intervals.push_back(times[i] - times[i - 1]);
  std::nth_element(intervals.begin(), intervals.begin() + static_cast<std::ptrdiff_t>(intervals.size() / 2), intervals.end());
  return intervals[intervals.size() / 2];
}

void remark_on(const MotionStream& stream, std::vector<std::string>& all) {
  const Real usual = median_interval(stream.times);
  for (std::size_t i = 1; i < stream.times.size(); ++i)
    if (const Real gap = stream.times[i] - stream.times[i - 1]; gap > 2.5 * usual)
      all.push_back(fmt::format("motion {}: a gap of {:g} s before {:g} s, where rows are usually {:g} s apart", stream.name, gap,
                                stream.times[i], usual));
  const auto& rows = stream.measured.empty() ? stream.commanded : stream.measured;
  Real largest = 0;
  bool degrees = true;
  for (std::size_t j = 0; j < stream.joints.size(); ++j) degrees = degrees && stream.joints[j].unit == Unit::deg;
  for (const robot::VecX& row : rows) largest = std::max(largest, row.cwiseAbs().maxCoeff());
  if (degrees && largest < std::numbers::pi)
    all.push_back(fmt::format("motion {}: no joint goes beyond {:.2g} deg; are these radians?", stream.name, largest));
}
}  // namespace

Real si_per(Unit unit) {
  switch (unit) {
    case Unit::deg:
      return std::numbers::pi / 180;
    case Unit::mm:
      return 1e-3;
    default:
      return 1;
  }
}

Episode::Span Episode::common() const {
  Span span{streams.front().times.front(), streams.front().times.back()};
  for (const MotionStream& stream : streams) {
    span.start = std::max(span.start, stream.times.front());
    span.end = std::min(span.end, stream.times.back());
  }
  return span;
}

const EpisodeCamera& Episode::camera(const std::string& wanted, const std::string& where) const {
  std::string names;
  for (const EpisodeCamera& one : cameras) {
    if (one.name == wanted) return one;
    names += (names.empty() ? "" : ", ") + one.name;
  }
  throw InputError(fmt::format("{}: there is no camera {} (allowed: {})", where, wanted, names.empty() ? "none is recorded" : names));
}

void require_sound(const Episode& episode, const std::string& where) {
  const Judge judge{where};
  judge.require(!episode.streams.empty(), "holds no motion (allowed: at least one)");
  std::set<std::string> joints, names;
  for (const MotionStream& stream : episode.streams) {
    judge.require(!stream.name.empty() && names.insert(stream.name).second, "motion '{}' is there twice or has no name", stream.name);
    judge_stream(judge.part("motion " + stream.name), stream, joints);
  }
  names.clear();
  for (const EpisodeCamera& camera : episode.cameras) {
    judge.require(!camera.name.empty() && names.insert(camera.name).second, "camera '{}' is there twice or has no name", camera.name);
    judge_camera(judge.part("camera " + camera.name), camera);
  }
  names.clear();
  for (const LandmarkTrack& track : episode.landmarks) {
    judge.require(names.insert(track.camera).second, "landmarks of camera {} are there twice", track.camera);
    judge_landmarks(judge.part("landmarks of camera " + track.camera), track, episode.camera(track.camera, where).calibration);
  }
}

std::vector<std::string> remarks(const Episode& episode) {
  std::vector<std::string> all;
  for (const MotionStream& stream : episode.streams) remark_on(stream, all);
  const auto [start, end] = episode.common();
  for (const LandmarkTrack& track : episode.landmarks) {
    const auto outside = std::count_if(track.landmarks.begin(), track.landmarks.end(),
                                       [from = start, to = end](const Landmark& mark) { return mark.time < from || mark.time > to; });
    if (outside > 0)
      all.push_back(fmt::format("landmarks of camera {}: {} lie before {:g} s or after {:g} s, where a motion is not recorded",
                                track.camera, outside, start, end));
  }
  return all;
}
}  // namespace cosim
