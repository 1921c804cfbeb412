#pragma once
#include "tape/core/types.hpp"

/// Exact geometric predicates on the doubles as they are: floating point where its error bound decides, rationals where not. Host only.
namespace tape {
/// Sign of the volume of the tetrahedron (a, b, c, d): +1 if d is on the side of the plane abc from which a, b, c turn
/// clockwise, 0 if the four points lie in one plane.  Source: filter of [Shewchuk 1997, orient3d, stage A].
int orientation(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d);

/// Sign of the area of (a, b, c) projected along coordinate `axis`: +1 if counter-clockwise in the plane of the other two.
int projected_orientation(const Vec3& a, const Vec3& b, const Vec3& c, int axis);

/// Whether the closed segment p-q and the closed triangle a-b-c have a point in common. Touching counts, coplanar too; degenerate
/// segments and triangles are the points that they are.
bool segment_meets_triangle(const Vec3& p, const Vec3& q, const Vec3& a, const Vec3& b, const Vec3& c);
}  // namespace tape
