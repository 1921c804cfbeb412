#include "robot/world/collision_shape.hpp"

namespace robot {
namespace {
std::unique_ptr<btCollisionShape> hull(const TriangleMesh& mesh, const std::string& link) {
  constexpr Real kMostShrink = 0.1;  // of the hull's inner radius
  if (mesh.vertices.size() < 4) throw InputError("link " + link + ": a collision mesh has fewer than four vertices");
  btConvexHullComputer inner;
  const int count = static_cast<int>(mesh.vertices.size());
  const Real shift = inner.compute(mesh.vertices[0].data(), sizeof(Vec3), count, CollisionShape::kMargin, kMostShrink);
  if (shift < 0 || inner.vertices.size() < 4) throw InputError("link " + link + ": a collision mesh has no volume");
  auto shape = std::make_unique<btConvexHullShape>();
  for (int i = 0; i < inner.vertices.size(); ++i) shape->addPoint(inner.vertices[i], false);
  shape->setMargin(shift);
  shape->recalcLocalAabb();
  return shape;
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
