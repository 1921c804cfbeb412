#pragma once
#include <numbers>

#include "cosim/scene/reader.hpp"
#include "tape/math/rotation.hpp"

namespace cosim {
inline constexpr Real kRadian = std::numbers::pi / 180;           // [rad/deg]
inline constexpr Range kPlace = Range::closed(-1e4, 1e4);         // [m], [m/s]
inline constexpr Range kSize = Range::above(0, 1e3);              // [m]
inline constexpr Range kAnyAngle = Range::closed(-36000, 36000);  // [deg], a hundred turns

/// A rotation from degrees: a rotation vector [x, y, z], or {axis: [x, y, z], angle: a}.
inline Mat3 read_rotation(const Reader& rotation) {
  if (!rotation.is_map()) return tape::rotation_exp(kRadian * rotation.vector(kAnyAngle, "deg"));
  const Reader axis = rotation["axis"];
  const Vec3 direction = axis.vector(kPlace, "");
  if (!(direction.norm() > 0)) axis.fail("has no direction");
  return tape::rotation_exp(kRadian * rotation["angle"].number(kAnyAngle, "deg") * direction.normalized());
}

/// `position` [m] and `rotation_deg` of a section; what it does not give is taken from `pose`.
inline Pose read_pose(const Reader& section, Pose pose = {}) {
  pose.position = section["position"].vector_or(pose.position, kPlace, "m");
  if (const Reader rotation = section["rotation_deg"]) pose.rotation = read_rotation(rotation);
  return pose;
}
}  // namespace cosim
