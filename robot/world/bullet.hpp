#pragma once
// Bullet is included here alone, by sources of this folder; and its hulls by model/convex_hull.cpp.
#include <BulletCollision/CollisionDispatch/btConvexConvexAlgorithm.h>
#include <BulletCollision/CollisionShapes/btEmptyShape.h>
#include <BulletCollision/NarrowPhaseCollision/btGjkEpaPenetrationDepthSolver.h>
#include <BulletDynamics/Featherstone/btMultiBody.h>
#include <BulletDynamics/Featherstone/btMultiBodyConstraintSolver.h>
#include <BulletDynamics/Featherstone/btMultiBodyDynamicsWorld.h>
#include <BulletDynamics/Featherstone/btMultiBodyJointLimitConstraint.h>
#include <BulletDynamics/Featherstone/btMultiBodyLinkCollider.h>
#include <btBulletCollisionCommon.h>

#include "robot/model/robot_model.hpp"

namespace robot {
inline btVector3 to_bullet(const Vec3& v) { return {v.x(), v.y(), v.z()}; }
inline btQuaternion to_bullet(const Mat3& R) {
  const Eigen::Quaterniond q(R);
  return {q.x(), q.y(), q.z(), q.w()};
}
inline btTransform to_bullet(const Pose& X) { return btTransform(to_bullet(Mat3(X.linear())), to_bullet(Vec3(X.translation()))); }
inline Vec3 from_bullet(const btVector3& v) { return {v.x(), v.y(), v.z()}; }
inline Pose from_bullet(const btTransform& X) {
  Pose pose = Pose::Identity();
  for (int row = 0; row < 3; ++row) pose.linear().row(row) = from_bullet(X.getBasis()[row]).transpose();
  pose.translation() = from_bullet(X.getOrigin());
  return pose;
}
}  // namespace robot
