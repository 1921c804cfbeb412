#pragma once
#include <vector>

#include "tape/core/types.hpp"

namespace tape {
using Line = std::vector<Vec2>;  ///< corners [m] of a polyline

/// The line without the corners that it does not need to stay within `tolerance` [m] of them.  Source: [Douglas 1973].
Line simplified(const Line& line, Real tolerance);

/// Mean of the line over a window [m] of arc length about each of its points, which shrinks to nothing towards the ends.
Line averaged(const Line& line, Real window);

/// Largest distance [m] of a corner of `line` from `other`.
Real deviation(const Line& line, const Line& other);
Real distance_to_line(const Vec2& p, const Line& line);
}  // namespace tape
