#pragma once
#include <cmath>
#include <limits>

#include "tape/math/mollifier.hpp"

namespace tape {
/// Barrier energy of a pair at distance d:  b(d) = w dhat/4 kappa (r - 1)^2 ln(r)^2,  r = (d^2 - xi^2)/(dhat^2 + 2 dhat xi),
/// infinite at contact (d = xi) and C1 zero from d = xi + dhat on.  Source: [Huang 2024], offset by thickness as in [Li 2021].
struct BarrierLaw {
  Real kappa;  ///< [Pa]
  Real dhat;   ///< [m]
  TAPE_HD bool reaches(Real d, Real xi) const { return d < xi + dhat; }
  /// Energy [J], slope [N] and curvature [N/m] at distance d [m] of a pair with offset xi [m] and weight w [m^2].
  TAPE_HD Jet at(Real d, Real xi, Real weight) const {
    if (!reaches(d, xi)) return {0, 0, 0};
    if (!(d > xi)) return {std::numeric_limits<Real>::infinity(), 0, 0};  // a trial step that the line search refuses
    const Real band = dhat * (dhat + 2 * xi), r = (d - xi) * (d + xi) / band;
    const Real scale = weight * dhat / 4 * kappa, l = std::log(r), a = r - 1;
    const Real slope = 2 * a * l * (l + a / r);  // by r
    const Real curvature = 2 * l * l + 8 * a * l / r + 2 * a * a * (1 - l) / (r * r);
    const Real r_d = 2 * d / band;
    return {scale * a * a * l * l, scale * slope * r_d, scale * (curvature * r_d * r_d + slope * 2 / band)};
  }
};
}  // namespace tape
