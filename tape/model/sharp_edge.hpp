#pragma once
#include <vector>

#include "tape/model/triangle_mesh.hpp"

namespace tape {
/// The longest line [corners] m of edges of a closed mesh at which it is sharper than `angle` [rad], the angle inside of the material. A
/// line that closes ends where it began. Lines that branch are none.
std::vector<Vec3> sharp_edge(const TriangleMesh& mesh, Real angle);
}  // namespace tape
