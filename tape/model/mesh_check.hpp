#pragma once
#include <string>

#include "tape/model/triangle_mesh.hpp"

namespace tape {
/// Checks that contact can work with a mesh: finite vertices, all of them used, indices in range, no triangle without area (its height
/// below 1e-9 of its longest side) or twice, at most two triangles at an edge, and those two oriented alike.
/// @param closed  also: no open edge, and a positive volume (normals outward); what a mass is computed from
/// @param name    of the body, with its file if it has one; messages start with it
/// @throws InputError naming the triangle and the reason
void check_mesh(const TriangleMesh& mesh, const std::string& name, bool closed);
}  // namespace tape
