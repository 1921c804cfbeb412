#include "tape/step/finish.hpp"

#include <Eigen/LU>

#include "tape/bodies/free_flight.hpp"
#include "tape/effects/axle_torque.inl"
#include "tape/effects/barrier.inl"
#include "tape/effects/body_drive.inl"
#include "tape/math/rotation.hpp"

namespace tape {
namespace {
/// Nearest rotation: products of rotations drift off by round-off.
Mat3 orthonormal(const Mat3& R) { return Eigen::Quaternion<Real>(R).normalized().toRotationMatrix(); }

void add_grip_forces(const World& world, const State& after, Real dt, StepReport& report) {
  if (world.assembly.grips.empty()) return;
  const Drive drive = Drive::at(world, after, after.time, dt);
  const auto x = [&](int v) { return vertex_position(world, after, static_cast<std::size_t>(v)); };
  std::size_t spring = 0;
  for (const Assembly::GripPart& grip : world.assembly.grips) {
    Vec3 force = Vec3::Zero();
    for (std::size_t k = 0; k < grip.vertices.size(); ++k, ++spring) {
      const int anchor = grip.anchors[k];
      const Vec3 target = anchor < 0 ? drive.grip_target[spring] : x(anchor);
      force += drive.grip_stiffness[spring] * (target - x(grip.vertices[k]));
    }
    report.grip_force.push_back(force);
  }
}
/// What holds a driven body bears what the world exerts on it.
void add_driven_forces(const World& world, const State& after, Real dt, StepReport& report) {
  std::vector<BodyDrive::Element> held;
  BodyDrive::build(world.setup.scene, world.assembly, params<BodyDrive>(world.setup.effects), held);
  if (held.empty()) return;
  const Drive drive = Drive::at(world, after, after.time, dt);
  for (const BodyDrive::Element& hold : held) {
    const auto b = static_cast<std::size_t>(hold.body);
    report.body_force[b] = hold.stiffness.gradient(after.bodies[b].pose, drive.body_target[b]).head<3>();
  }
}
void add_axle_torques(const World& world, const State& before, const State& after, Real dt, StepReport& report) {
  const std::vector<Vec3> start = vertex_positions(world, before), end = vertex_positions(world, after);
  StateView s{};
  s.dt = dt;
  s.x = {end.data(), static_cast<int>(end.size())}, s.x_start = {start.data(), static_cast<int>(start.size())};
  std::vector<AxleTorque::Element> elements;
  AxleTorque term = AxleTorque::build(world.setup.scene, world.assembly, params<AxleTorque>(world.setup.effects), elements);
  term.elements = {elements.data(), static_cast<int>(elements.size())};
  for (int i = 0; i < term.elements.size; ++i) {
    report.axle_torque.push_back(term.torque(s, i));
    report.axle_work += report.axle_torque.back() * (term.slip(s, i) + elements[static_cast<std::size_t>(i)].speed * dt);
  }
}
}  // namespace

void finish_body(const BodyMass& mass, const Pose& pose, const Pose& target, Real dt, BodyState& body) {
  body.velocity = (pose.position - body.pose.position) / dt;
  if (mass.mass > 0) body.angular_momentum += axial(pose.rotation * mass.second * target.rotation.transpose()) / dt;
  body.pose = {orthonormal(pose.rotation), pose.position};
}

void finish_step(const World& world, const Carriage& carriage, const State& before, const State& after, Real dt, StepReport& report) {
  report.kinetic = 0;
  for (std::size_t v = 0; v < after.x.size(); ++v) {
    if (carriage.mass[v] == 0) continue;  // a member of a cluster
    report.kinetic += carriage.mass[v] * after.v[v].squaredNorm() / 2;
    report.momentum += carriage.mass[v] * after.v[v];
    report.angular_momentum += carriage.mass[v] * after.x[v].cross(after.v[v]);
  }
  for (std::size_t b = 0; b < after.bodies.size(); ++b) {
    const BodyState& body = after.bodies[b];
    const BodyMass& mass = carriage.body_mass[b];
    report.body_pose.push_back(body.pose);
    report.body_force.push_back(mass.mass * ((body.velocity - before.bodies[b].velocity) / dt - world.setup.scene.gravity));
    if (!(mass.mass > 0)) continue;
    const Mat3 inertia = body.pose.rotation * inertia_tensor(mass.second) * body.pose.rotation.transpose();
    report.kinetic +=
        mass.mass * body.velocity.squaredNorm() / 2 + body.angular_momentum.dot(inertia.inverse() * body.angular_momentum) / 2;
    report.momentum += mass.mass * body.velocity;
    report.angular_momentum += mass.mass * body.pose.position.cross(body.velocity) + body.angular_momentum;
  }
  add_driven_forces(world, after, dt, report);
  add_grip_forces(world, after, dt, report);
  if (!world.assembly.axles.empty()) add_axle_torques(world, before, after, dt, report);
}

std::vector<Real> vertex_contact_force(const World& world, const std::vector<ContactPair>& pairs, const std::vector<Vec3>& x) {
  std::vector<typename Barrier::Element> none;
  Barrier barrier = Barrier::build(world.setup.scene, world.assembly, params<Barrier>(world.setup.effects), none);
  barrier.elements = {pairs.data(), static_cast<int>(pairs.size())};
  StateView s{};
  s.x = {x.data(), static_cast<int>(x.size())};
  std::vector<Vec3> force(x.size(), Vec3::Zero());
  for (int i = 0; i < barrier.elements.size; ++i) {
    if (!barrier.active(s, i)) continue;
    const VecN<12> g = barrier.gradient(s, i);
    for (int k = 0; k < 4; ++k) force[static_cast<std::size_t>(pairs[static_cast<std::size_t>(i)].v[k])] -= g.segment<3>(3 * k);
  }
  std::vector<Real> magnitude;
  for (const Vec3& f : force) magnitude.push_back(f.norm());
  return magnitude;
}
}  // namespace tape
