#include "tape/model/motion.hpp"

#include <algorithm>

#include "tape/math/rotation.hpp"

namespace tape {
namespace {
/// The first of `keys` after time t.
template <class Key>
typename std::vector<Key>::const_iterator following(const std::vector<Key>& keys, Real t) {
  return std::upper_bound(keys.begin(), keys.end(), t, [](Real time, const Key& key) { return time < key.time; });
}
}  // namespace

Pose driven_pose(const Body& body, Real t) {
  if (body.waypoints.empty()) return {rotation_exp(t * body.angular_velocity) * body.pose.rotation, body.pose.position + t * body.velocity};
  const auto next = following(body.waypoints, t);
  if (next == body.waypoints.begin()) return next->pose;
  const Waypoint& last = *(next - 1);
  if (next == body.waypoints.end()) return last.pose;
  const Real linear = (t - last.time) / (next->time - last.time);
  const Real s = next->ease ? linear * linear * (3 - 2 * linear) : linear;
  const Vec3 turn = rotation_log(next->pose.rotation * last.pose.rotation.transpose());
  return {rotation_exp(s * turn) * last.pose.rotation, last.pose.position + s * (next->pose.position - last.pose.position)};
}

Vec3 grip_offset(const Grip& grip, Real t) {
  if (grip.motion.empty()) return Vec3::Zero();
  const auto next = following(grip.motion, t);
  if (next == grip.motion.begin()) return next->offset;
  const Grip::Key& last = *(next - 1);
  if (next == grip.motion.end()) return last.offset;
  return last.offset + (t - last.time) / (next->time - last.time) * (next->offset - last.offset);
}
}  // namespace tape
