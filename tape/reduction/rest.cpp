#include "tape/reduction/rest.hpp"

#include "tape/math/rotation.hpp"

namespace tape {
OnHub on_hub(const Pose& hub, const Pose& cluster, const Vec3& centre) {
  return {cluster.rotation.transpose() * (hub.position - cluster.position) + centre, hub.rotation.transpose() * cluster.rotation};
}
Pose stands(const OnHub& at, const Pose& hub, const Vec3& centre) {
  const Mat3 R = hub.rotation * at.turn;
  return {R, hub.position - R * (at.foot - centre)};
}
Real displaced(const OnHub& at, Real radius, const Pose& hub, const Pose& cluster, const Vec3& centre) {
  const Vec3 foot = apply(cluster, at.foot - centre);
  return (foot - hub.position).norm() + radius * rotation_log(hub.rotation.transpose() * cluster.rotation * at.turn.transpose()).norm();
}
}  // namespace tape
