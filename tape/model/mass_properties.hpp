#pragma once
#include "tape/model/triangle_mesh.hpp"

namespace tape {
/// Integrals over the inside of a closed mesh; times a density they are mass and inertia.
struct MassProperties {
  Real volume = 0;             ///< [m^3] negative if the normals point inward
  Vec3 centre = Vec3::Zero();  ///< [m]   in the frame of the mesh
  Mat3 second = Mat3::Zero();  ///< [m^5] integral of y y^T, y from the centre; the inertia tensor is density (tr(second) I - second)
};
/// Exact for the polyhedron: a sum over the tetrahedra that its triangles form with a common point.
/// Assumes a closed, consistently oriented mesh.
MassProperties mass_properties(const TriangleMesh& mesh);
/// Of a cylinder with a bore, exact; axis z, about its middle.
MassProperties ring_properties(Real inner_radius, Real outer_radius, Real height);
}  // namespace tape
