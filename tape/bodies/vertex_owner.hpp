#pragma once

namespace tape {
/// What moves a vertex. `block` is its first 3-block of unknowns, -1 if it is fixed; `body` the rigid body that carries it,
/// -1 if the vertex is itself an unknown. A rigid body has two blocks: translation, then rotation about its centre.
/// A free vertex that lies on a body may ride it: its trial steps end where its own unknowns say, on an arc about that body's centre.
struct VertexOwner {
  int block = -1;
  int body = -1;
  int ride = -1;        ///< body that a free vertex rides; -1: none, its trial steps are straight
  int ride_block = -1;  ///< first block of that body
};
}  // namespace tape
