#pragma once
#include <filesystem>

#include "robot/model/robot_model.hpp"

namespace robot {
/// Convex hull as a closed mesh whose vertices are points of the input. Bullet rounds the points to about 1e-4 of their extent while it
/// decides which of them lie on the hull, so points closer to its surface than that may stay outside.
/// @param points  [n] m
/// @throws InputError if they lie in one plane, or are not finite
TriangleMesh convex_hull(const std::vector<Vec3>& points);

/// The same, kept in a file of that folder under a hash of the points. A file that does not hold a closed mesh over the points is written
/// anew; a folder that cannot be written in is done without, as is an empty name.
/// @param cache  made if it does not exist
TriangleMesh convex_hull(const std::vector<Vec3>& points, const std::filesystem::path& cache);

/// What is inside the hull by a distance.
struct ShrunkHull {
  std::vector<Vec3> vertices;  ///< [m]
  Real by = 0;                 ///< [m] how far its faces moved
};
/// The hull with every face moved inwards by a distance [m], or by a tenth of the hull's inner radius if that is less; rounded as the hull.
/// @throws InputError as convex_hull
ShrunkHull shrunk_hull(const std::vector<Vec3>& points, Real by);
}  // namespace robot
