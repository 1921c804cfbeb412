#pragma once

namespace tape {
/// What moves a vertex. `block` is its first 3-block of unknowns, -1 if it is fixed; `body` the rigid body that carries it,
/// -1 if the vertex is itself an unknown. A rigid body has two blocks: translation, then rotation about its centre.
struct VertexOwner {
  int block = -1;
  int body = -1;
};
}  // namespace tape
