#pragma once
#include "cosim/episode/episode.hpp"

namespace cosim {
/// The motion at other times, linear between the recorded rows; nothing is filtered or shifted.
/// @param times    [n] s, within the recorded ones
/// @param max_gap  [s] longest interval between two rows that may be bridged
/// @throws InputError naming `where`, the stream and the time: before or after the recording, or in a gap
MotionStream resampled(const MotionStream& stream, const std::vector<Real>& times, Real max_gap, const std::string& where);

/// Times first, first + 1/rate, ... that all streams of an episode have recorded.  @param rate  [1/s]
/// @throws InputError naming `where` if there is no such time
std::vector<Real> common_times(const Episode& episode, Real rate, const std::string& where);

/// @throws InputError naming `where`, the stream and the time of the first interval above max_gap [s] that reaches beyond `start` [s]
void require_no_gap(const MotionStream& stream, Real start, Real max_gap, const std::string& where);
}  // namespace cosim
