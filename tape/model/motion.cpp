#include "tape/model/motion.hpp"

#include <algorithm>

#include "tape/math/rotation.hpp"

namespace tape {
namespace {
/// The first waypoint after time t.
std::vector<Waypoint>::const_iterator following(const std::vector<Waypoint>& waypoints, Real t) {
  return std::ranges::upper_bound(waypoints, t, {}, &Waypoint::time);
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

Vec3 grip_offset(const Grip& grip, Real t, const std::vector<Real>& events) {
  Vec3 offset = Vec3::Zero();
  for (const Grip::Move& move : grip.motion) {
    const Real gone = std::min(t, move.until < 0 ? t : Moment(0, move.until).at(events)) - move.start.at(events);
    if (gone > 0) offset += std::min(gone / move.duration, 1.0) * move.by;
  }
  return offset;
}
}  // namespace tape
