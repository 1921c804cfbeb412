#pragma once
#include "tape/core/types.hpp"

namespace tape {
/// A function of one variable with its first two derivatives.
struct Jet {
  Real value, slope, curvature;
};

/// Fades edge-edge pairs out as the edges become parallel, where their distance is not smooth:
///   m(c) = 2 c/eps - (c/eps)^2  for c = |ea x eb|^2 < eps, and 1 beyond; C1 at eps, 0 for parallel edges.
/// c, eps [m^4].  Source: [Li 2020, eq. 24].
TAPE_HD inline Jet edge_edge_mollifier(Real c, Real eps) {
  if (!(c < eps)) return {1, 0, 0};
  const Real r = c / eps;
  return {r * (2 - r), 2 * (1 - r) / eps, -2 / (eps * eps)};
}
}  // namespace tape
