#pragma once
#include <limits>

#include "tape/contact/pair.hpp"
#include "tape/core/side.hpp"

namespace tape {
/// The pair of smallest gap d - xi.
struct SmallestGap {
  Real gap = std::numeric_limits<Real>::infinity();  ///< [m]
  int pair = -1;                                     ///< index into the candidates, the first of equals; -1: there is none
};
}  // namespace tape

namespace tape::TAPE_SIDE {
namespace detail {
struct GapOfPair {
  Span<const ContactPair> pairs;
  Span<const Vec3> x;
  TAPE_HD SmallestGap operator()(int i) const {
    const ContactPair& p = pairs[i];
    const Vec3 at[4] = {x[p.v[0]], x[p.v[1]], x[p.v[2]], x[p.v[3]]};
    return {combine(closest(p.kind, at).weight, at).norm() - p.xi, i};
  }
};
struct SmallerGap {
  TAPE_HD SmallestGap operator()(const SmallestGap& a, const SmallestGap& b) const { return b.gap < a.gap ? b : a; }
};
}  // namespace detail

/// @param x  [nv] m, where no vertex has left the trust box that the candidates stand for
inline SmallestGap smallest_gap(Span<const ContactPair> pairs, Span<const Vec3> x) {
  return reduce(pairs.size, SmallestGap{}, detail::GapOfPair{pairs, x}, detail::SmallerGap{});
}
}  // namespace tape::TAPE_SIDE
