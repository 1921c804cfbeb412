#include "robot/world/collision_shape.hpp"

#include "robot/model/convex_hull.hpp"

namespace robot {
namespace {
std::unique_ptr<btCollisionShape> hull(const TriangleMesh& mesh, const std::string& link) {
  try {
    const ShrunkHull inner = shrunk_hull(mesh.vertices, CollisionShape::kMargin);
    auto shape = std::make_unique<btConvexHullShape>();
    for (const Vec3& p : inner.vertices) shape->addPoint(to_bullet(p), false);
    shape->setMargin(inner.by);
    shape->recalcLocalAabb();
    return shape;
  } catch (const InputError& e) {
    throw InputError("link " + link + ", collision mesh: " + e.what());
  }
}

std::unique_ptr<btCollisionShape> part(const Shape& shape, const std::string& link) {
  if (shape.kind == Shape::Kind::sphere) return std::make_unique<btSphereShape>(shape.size.x());
  if (shape.kind != Shape::Kind::box) return hull(shape.mesh, link);
  auto box = std::make_unique<btBoxShape>(to_bullet(Vec3(shape.size / 2)));
  box->setMargin(std::min(CollisionShape::kMargin, shape.size.minCoeff() / 4));  // keeps the outer size
  return box;
}
}  // namespace

CollisionShape::CollisionShape(const Link& link, const Pose& X_CL) {
  for (const Shape& shape : link.collision) {
    parts_.push_back(part(shape, link.name));
    compound_.addChildShape(to_bullet(X_CL * shape.X_LS), parts_.back().get());
  }
}
}  // namespace robot
