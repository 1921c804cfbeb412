#include "cosim/run/energy_ledger.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "tape/effects/body_inertia.inl"
#include "tape/math/rotation.hpp"

namespace cosim {
namespace {
/// Energy [J] of the springs of all grips at the vertices x [nv].
Real grip_energy(const World& world, const std::vector<Vec3>& x, const Drive& drive) {
  Real sum = 0;
  std::size_t spring = 0;
  for (const Assembly::GripPart& grip : world.assembly.grips)
    for (std::size_t k = 0; k < grip.vertices.size(); ++k, ++spring) {
      const Vec3& target = grip.anchors[k] < 0 ? drive.grip_target[spring] : x[static_cast<std::size_t>(grip.anchors[k])];
      sum += 0.5 * drive.grip_stiffness[spring] * (x[static_cast<std::size_t>(grip.vertices[k])] - target).squaredNorm();
    }
  return sum;
}
}  // namespace

EnergyLedger::EnergyLedger(const World& world) : world_(&world) {
  BodyDrive::build(world.setup.scene, world.assembly, params<BodyDrive>(world.setup.effects), drives_);
}

void EnergyLedger::before(const State& state, Real dt) {
  start_ = state;
  close_grips(*world_, start_);
  target_ = Drive::at(*world_, start_, start_.time + dt, dt);
  const std::vector<Vec3> x = vertex_positions(*world_, start_);
  grip_work_ = grip_energy(*world_, x, target_) - grip_energy(*world_, x, Drive::at(*world_, start_, start_.time, 0));
}

Real EnergyLedger::body_work(const State& state) const {
  Real work = 0;
  for (const BodyDrive::Element& drive : drives_) {
    const auto b = static_cast<std::size_t>(drive.body);
    const Pose &from = start_.bodies[b].pose, &to = state.bodies[b].pose;
    VecN<6> move;
    move << to.position - from.position, rotation_log(to.rotation * from.rotation.transpose());
    work -= drive.stiffness.gradient(to, target_.body_target[b]).dot(move);
  }
  return work;
}

/// [J] of the links on what they touch, at the forces of the step's end.
Real EnergyLedger::link_work(const StepReport& report) {
  Real work = 0;
  for (const ArticulationReport& a : report.articulations) work -= a.force.dot(a.q);
  return work;
}

EnergyLedger::Entry EnergyLedger::after(const State& state, const StepReport& report) {
  std::vector<Real> energies;
  for (const EffectReport& effect : report.effects) energies.push_back(effect.energy);
  const bool first = !std::exchange(started_, true);
  if (first) {
    first_energies_ = energies;
    first_energy_ = report.kinetic;
  } else {
    work_ += grip_work_ + body_work(state) + link_work(report) + report.adhesion_work + report.woken + report.axle_work;
  }
  Entry entry{.work = work_};
  Real about = report.kinetic + std::abs(work_);
  for (std::size_t e = 0; e < energies.size(); ++e) {
    const Real change = energies[e] - first_energies_[e];
    entry.potential += change;
    about += std::abs(change);
  }
  entry.balance = report.kinetic - first_energy_ + entry.potential - work_;
  entry.scale = scale_ = std::max(scale_, about);
  return entry;
}
}  // namespace cosim
