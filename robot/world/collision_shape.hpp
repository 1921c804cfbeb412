#pragma once
#include <memory>
#include <vector>

#include "robot/world/bullet.hpp"

namespace robot {
/// Bullet's counterpart of a link's collision shapes, each convex: boxes and spheres as they are, cylinders and meshes as the convex
/// hull of their mesh. Surfaces stand where the model has them: hulls are shrunk by Bullet's margin, which is added around them.
class CollisionShape {
 public:
  static constexpr Real kMargin = 1e-4;  ///< [m] rounds the edges; GJK works on what is left inside

  /// @param X_CL  of the link in the collider's frame
  CollisionShape(const Link& link, const Pose& X_CL);
  btCollisionShape& bullet() { return empty() ? static_cast<btCollisionShape&>(none_) : compound_; }
  bool empty() const { return parts_.empty(); }

 private:
  btEmptyShape none_;
  std::vector<std::unique_ptr<btCollisionShape>> parts_;
  btCompoundShape compound_;
};
}  // namespace robot
