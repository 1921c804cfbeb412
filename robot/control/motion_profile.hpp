#pragma once
#include <algorithm>
#include <cmath>

#include "robot/model/robot_model.hpp"

namespace robot {
/// How far along a move from rest to rest is, over the fraction s in [0, 1] of its time:
///   value = 10 s^3 - 15 s^4 + 6 s^5,
/// the path of least jerk [Flash 1985]. Velocity and acceleration vanish at both ends; it never overshoots. A move over D in time T has the
/// peak speed 15/8 D/T (half way) and the peak acceleration 10/sqrt(3) D/T^2 (at s = 1/2 -+ sqrt(3)/6).
struct MotionProfile {
  Real value, slope, curvature;  ///< by s

  static MotionProfile at(Real s) {
    return {s * s * s * (10 + s * (-15 + s * 6)), 30 * s * s * (1 - s) * (1 - s), 60 * s * (1 - s) * (1 - 2 * s)};
  }
  /// Peak speed over a distance in a time; the unit is that of distance, per second.
  static Real peak_speed(Real distance, Real time) { return 15. / 8 * distance / time; }
  static Real peak_acceleration(Real distance, Real time) { return 10 / std::sqrt(3.) * distance / (time * time); }
  /// Shortest time [s] over a distance within limits of speed and acceleration, both > 0.
  static Real shortest_time(Real distance, Real speed, Real acceleration) {
    return std::max(15. / 8 * distance / speed, std::sqrt(10 / std::sqrt(3.) * distance / acceleration));
  }
};
}  // namespace robot
