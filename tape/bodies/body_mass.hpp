#pragma once
#include "tape/core/types.hpp"

namespace tape {
/// Mass of a rigid body about its centre of mass.
struct BodyMass {
  Real mass = 0;               ///< [kg]
  Mat3 second = Mat3::Zero();  ///< [kg m^2] sum of m y y^T in the body's frame; the inertia tensor is tr(second) I - second
};
}  // namespace tape
