#pragma once
#include <cmath>

#include "robot/model/robot_model.hpp"

namespace robot {
/// Active set of one force f = clamp(unclamped, +- limit), linear in an unknown velocity: side is 0 where it is within its limit, else the
/// sign of the limit that it stands at.
/// @param unclamped  at the velocity that was found
/// @param release    false: it may only come to its limit, so that repeating ends
/// @returns whether the side has changed, and the velocity must be found again
inline bool update_side(int& side, Real unclamped, Real limit, bool release) {
  constexpr Real kTie = 1e-12;  // relative: a force at its limit to round-off stays where it is
  const int before = side;
  if (side == 0 && std::abs(unclamped) > limit * (1 + kTie)) side = unclamped > 0 ? 1 : -1;
  if (side != 0 && release && side * unclamped < limit * (1 - kTie)) side = 0;
  return side != before;
}
}  // namespace robot
