#pragma once
#include "tape/core/types.hpp"

namespace tape {
/// The triangles around each vertex, as the other two corners of each in its sense.
struct VertexFans {
  Span<const int> first;  ///< [nv + 1] corners[first[v] ... first[v + 1]) are those of v
  Span<const Index2> corners;
  /// Twice the sum of area times normal of the triangles around a vertex.  @param x  [nv] m  @return [m^2]
  TAPE_HD Vec3 area_normal(Span<const Vec3> x, int v) const {
    Vec3 sum = Vec3::Zero();
    for (int k = first[v]; k < first[v + 1]; ++k) sum += (x[corners[k][0]] - x[v]).cross(x[corners[k][1]] - x[v]);
    return sum;
  }
};
}  // namespace tape
