#include "cosim/episode/resample.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace cosim {
namespace {
/// Intervals are differences of rounded times: one at the limit is allowed.
bool is_gap(Real interval, Real max_gap) { return interval > max_gap * (1 + 1e-9); }

[[noreturn]] void refuse_gap(const MotionStream& stream, Real from, Real to, Real max_gap, const std::string& where) {
  throw InputError(
      fmt::format("{}: motion {}: a gap from {:g} s to {:g} s (allowed: up to {:g} s)", where, stream.name, from, to, max_gap));
}

/// Row before a time, and the share of the way to the next.
struct Place {
  std::size_t row;
  Real share;
};
robot::VecX at(const std::vector<robot::VecX>& rows, const Place& place) {
  if (place.share == 0) return rows[place.row];
  return (1 - place.share) * rows[place.row] + place.share * rows[place.row + 1];
}
}  // namespace

MotionStream resampled(const MotionStream& stream, const std::vector<Real>& times, Real max_gap, const std::string& where) {
  MotionStream result{.name = stream.name, .joints = stream.joints, .times = times};
  for (const Real t : times) {
    if (!(t >= stream.times.front() && t <= stream.times.back()))
      throw InputError(fmt::format("{}: motion {}: {:g} s is not recorded (allowed: {:g} to {:g} s)", where, stream.name, t,
                                   stream.times.front(), stream.times.back()));
    const auto after = std::upper_bound(stream.times.begin(), stream.times.end(), t);
    Place place{static_cast<std::size_t>(after - stream.times.begin()) - 1, 0};
    if (const Real from = stream.times[place.row]; from < t) {
      if (is_gap(*after - from, max_gap)) refuse_gap(stream, from, *after, max_gap, where);
      place.share = (t - from) / (*after - from);
    }
    if (!stream.measured.empty()) result.measured.push_back(at(stream.measured, place));
    if (!stream.commanded.empty()) result.commanded.push_back(at(stream.commanded, place));
  }
  return result;
}

std::vector<Real> common_times(const Episode& episode, Real rate, const std::string& where) {
  const auto [first, last] = episode.common();
  if (!(first <= last))
    throw InputError(fmt::format("{}: its motions have no time in common: one starts at {:g} s, one ends at {:g} s", where, first, last));
  std::vector<Real> times;
  for (Real t = first; t <= last; t = first + static_cast<Real>(times.size()) / rate) times.push_back(t);
  return times;
}

void require_no_gap(const MotionStream& stream, Real start, Real max_gap, const std::string& where) {
  for (std::size_t i = 1; i < stream.times.size(); ++i)
    if (stream.times[i] > start && is_gap(stream.times[i] - stream.times[i - 1], max_gap))
      refuse_gap(stream, stream.times[i - 1], stream.times[i], max_gap, where);
}
}  // namespace cosim
