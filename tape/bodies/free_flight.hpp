#pragma once
#include "tape/core/types.hpp"

namespace tape {
/// Torque-free rotation over dt [s]: the pose that a body with angular momentum L [kg m^2/s, world] reaches from rotation R.
/// Euler's equations in the body by the implicit midpoint rule, the rotation by the Cayley map of the same mean angular
/// velocity: |L|, its direction and the kinetic energy are kept to round-off for any dt [Simo 1991, Austin 1993].
/// @param second  [kg m^2] sum of m y y^T in the body's frame
Mat3 free_flight(const Mat3& R, const Vec3& L, const Mat3& second, Real dt);

/// Inertia tensor [kg m^2] of second moments: tr(S) I - S.
inline Mat3 inertia_tensor(const Mat3& second) { return second.trace() * Mat3::Identity() - second; }
}  // namespace tape
