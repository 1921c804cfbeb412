#pragma once
#include "tape/core/types.hpp"

namespace tape {
/// Smoothed Coulomb friction [Li 2020]: a slip y >= 0 in a step costs its limit times
///   f0(y) = y for y >= eps, else -y^3/(3 eps^2) + y^2/eps + eps/3.
/// f0 is convex and C2 but for its third derivative; below eps a contact creeps instead of sticking.
struct Coulomb {
  Real eps;  ///< in units of the slip, above 0
  TAPE_HD Real value(Real y) const { return y >= eps ? y : y * y / eps * (1 - y / (3 * eps)) + eps / 3; }
  /// f0'(y)/y: the parabola with it through y lies above f0 everywhere.
  TAPE_HD Real secant(Real y) const { return y >= eps ? 1 / y : (2 - y / eps) / eps; }
  /// f0'(y)/y - f0''(y).
  TAPE_HD Real bend(Real y) const { return y >= eps ? 1 / y : y / (eps * eps); }
};
}  // namespace tape
