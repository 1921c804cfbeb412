#include "apps/tapesim/hub_watch.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace tape::tapesim {
namespace {
int find_body(const Scene& scene, const std::string& name) {
  const auto found = std::ranges::find(scene.bodies, name, &Body::name);
  return found == scene.bodies.end() ? -1 : static_cast<int>(found - scene.bodies.begin());
}

/// Bore and height of a ring about z whose middle is the origin.
score::Hub ring(const Body& body) {
  Real inner = std::numeric_limits<Real>::infinity(), low = inner, high = -inner;
  for (const Vec3& v : body.mesh.vertices) {
    inner = std::min(inner, v.head<2>().norm());
    low = std::min(low, v.z()), high = std::max(high, v.z());
  }
  constexpr Real kRound = 1e-9;  // [m]
  if (!(inner > kRound && high > low && std::abs(high + low) < kRound))
    throw InputError("body " + body.name + ": is no ring about its z axis, of which there are landmarks");
  return {.X_WH = body.pose, .inner_radius = inner, .height = high - low};
}
}  // namespace

HubShape::HubShape(const World& world, const std::string& name) : body_(find_body(world.setup.scene, name)) {
  if (body_ < 0) throw InputError("the scene has no body " + name + ", of which there are landmarks");
  shape_ = ring(world.setup.scene.bodies[static_cast<std::size_t>(body_)]);
  offset_ = -world.assembly.bodies[static_cast<std::size_t>(body_)].mesh_offset;
}

score::Hub HubShape::at(const State& state) const { return at(state.bodies[static_cast<std::size_t>(body_)].pose); }

score::Hub HubShape::at(const Pose& X_WB) const {
  score::Hub hub = shape_;
  hub.X_WH = {X_WB.rotation, tape::apply(X_WB, offset_)};
  return hub;
}

Mount::Mount(const std::string& name, const World& world, const cosim::RobotScene& robots, const cosim::CoupledStepper* stepper)
    : stepper_(stepper) {
  if (name == "world" || name.empty()) return;
  for (std::size_t r = 0; r < robots.robots.size(); ++r) {
    const std::string prefix = robots.robots[r].name + ":";
    if (!name.starts_with(prefix)) continue;
    if (const auto frame = robots.robots[r].model->find_frame(name.substr(prefix.size())))
      robot_ = static_cast<int>(r), link_ = frame->link, X_LF_ = frame->X_LF;
  }
  if (robot_ >= 0) return;
  body_ = find_body(world.setup.scene, name);
  if (body_ < 0) throw InputError("a camera stands on " + name + ": no body and no link or frame robot:link has this name");
}

Pose Mount::at(const State& state) const {
  if (robot_ >= 0) return cosim::to_tape(stepper_->bullet().link_pose(robot_, link_) * X_LF_);
  return body_ < 0 ? Pose{} : state.bodies[static_cast<std::size_t>(body_)].pose;
}

void HubWatch::add(const State& state) {
  seen_.times.push_back(state.time);
  seen_.states.push_back(hub_.at(state));
  if (!mount_.is_world()) seen_.mounts.push_back(mount_.at(state));
}
}  // namespace tape::tapesim
