#pragma once
#include <string>
#include <vector>

#include "tape/contact/pair.hpp"
#include "tape/contact/surface.hpp"

/// Checks of whole states, on the host.
namespace tape {
/// An edge that meets a triangle.
struct Crossing {
  int edge, triangle;  ///< indices into the surface
  Vec3 where;          ///< [m] the middle of the edge's part nearest to the triangle's plane: for messages only
};
struct Intersections {
  int count = 0;
  std::vector<Crossing> first;  ///< the first few, by the ids of edge and triangle
};
/// All edges that meet triangles, touching included, among primitives that may form a pair (surface.hpp). The decision is exact
/// for the coordinates as they are: no tolerance.
/// @param x  [nv] m, finite
Intersections find_intersections(const SurfaceMesh& mesh, const std::vector<Vec3>& x, int keep = 5);
/// @param owner  [nv] what carries each vertex, if not as the mesh says: members of a cluster, which form no pair
Intersections find_intersections(const SurfaceMesh& mesh, const std::vector<VertexOwner>& owner, const std::vector<Vec3>& x, int keep = 5);

/// For messages: "strip edge 4-5 and table triangle 0-1-2 at (0.1, 0.2, 0) m", with vertices numbered within their objects.
std::string description(const SurfaceMesh& mesh, const Crossing& crossing);
/// @param x  [nv] m
std::string description(const SurfaceMesh& mesh, const ContactPair& pair, const std::vector<Vec3>& x);

/// Requires a state from which the barrier can start: finite, nothing intersects, every gap is positive.
/// @param x     [nv] m
/// @param dhat    [m] activation distance
/// @param bonded  pairs whose gap does not count (ContactSearch::set_bonded)
/// @throws InputError naming objects, primitives, place and gap of the first crossing or else of the smallest gap
void check_start(const std::vector<Vec3>& x, const SurfaceMesh& mesh, Real dhat, const std::vector<VertexTriangle>& bonded = {});
}  // namespace tape
