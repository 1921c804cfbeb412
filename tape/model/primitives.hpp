#pragma once
#include "tape/model/triangle_mesh.hpp"

/// Closed surfaces (but for the sheet) with outward normals, centred on the origin unless said otherwise; lengths in metres.
/// Round things are inscribed polygons: their flats lie inside by the sagitta r (1 - cos(pi / segments)).
namespace tape {
/// Cells per edge: more vertices for thin things that rest on it.
TriangleMesh box_mesh(const Vec3& size, const Index3& cells = {1, 1, 1});

/// Axis z. @param bands  cells along the axis
TriangleMesh cylinder_mesh(Real radius, Real height, int segments, int bands);

/// A cylinder with a real bore: tape cores. Axis z.
TriangleMesh ring_mesh(Real inner_radius, Real outer_radius, Real height, int segments, int bands);

/// Icosahedron whose triangles are split in four `subdivisions` times.
TriangleMesh sphere_mesh(Real radius, int subdivisions);

/// A cylinder of this height between two half spheres. Axis z.
TriangleMesh capsule_mesh(Real radius, Real height, int segments);

/// Open rectangle in the plane z = 0, normal +z.
TriangleMesh sheet_mesh(const Vec2& size, const Index2& cells);

/// A ridge: base size.x by size.y in the plane z = 0, edge along y at height size.z above its middle.
TriangleMesh wedge_mesh(const Vec3& size);

/// A pyramid or cone: base of `segments` corners at `radius` in the plane z = 0, tip at `height`.
TriangleMesh spike_mesh(Real radius, Real height, int segments);
}  // namespace tape
