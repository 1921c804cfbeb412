#pragma once
#include "tape/core/types.hpp"

/// Exact answers that studies and tests measure against.
namespace tape::report {
/// Where the tip of a heavy elastica comes to rest, in units of its length.
struct ElasticaTip {
  Real drop;   ///< [1] below the clamp
  Real reach;  ///< [1] horizontally from the clamp
  Real angle;  ///< [rad] of the tip below the horizontal
};
/// Inextensible strip of length L, weight w per length [N/m] and bending stiffness B [N m^2], clamped horizontally:
///   B theta'' = -w (L - s) cos theta,  theta(0) = 0,  theta'(L) = 0,
/// solved by shooting from the tip with classical Runge-Kutta; good to 1e-8 up to gamma 1000.
/// @param gamma  [1] w L^3 / B, in [0, 1000]
/// @throws SettingsError for another gamma
ElasticaTip heavy_elastica(Real gamma);

/// Ratio of the pulls at the two ends of a band that slides around a cylinder: exp(mu angle).
/// @param mu  [1] friction  @param angle  [rad] of contact
Real capstan_ratio(Real mu, Real angle);

/// Force per width F/b [N/m] that peels an elastic film off, from (F/b)^2/(2 E h) + (F/b)(1 - cos angle) = R.  Source: [Kendall 1975].
/// @param toughness  [J/m^2] R  @param angle  [rad]  @param stretch  [N/m] E h
Real peel_force(Real toughness, Real angle, Real stretch);
}  // namespace tape::report
