#pragma once

namespace tape {
/// What moves a vertex. `block` is its first 3-block of unknowns, -1 if it is fixed; `body` the rigid body that carries it,
/// -1 if the vertex is itself an unknown. A rigid body has two blocks: translation, then rotation about its centre.
/// Tape that is wound on a body, and the cluster that its wound part is, may ride that body: trial steps then are arcs about its centre.
struct VertexOwner {
  int block = -1;
  int body = -1;
  int ride = -1;        ///< body that is ridden; -1: none
  int ride_block = -1;  ///< first block of that body
};
}  // namespace tape
