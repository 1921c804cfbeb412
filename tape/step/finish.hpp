#pragma once
#include <vector>

#include "tape/contact/pair.hpp"
#include "tape/step/stepper.hpp"

/// Host work at the end of a step, shared by both sides.
namespace tape {
/// Velocity and angular momentum of a body from the pose that a step of dt ended at. The inertial target is where it would
/// have gone alone; what the rotation differs from it is the angular impulse of all forces:  dL = axial(R S R_target^T) / dt.
void finish_body(const BodyMass& mass, const Pose& pose, const Pose& target, Real dt, BodyState& body);

/// Kinetic energy, momenta, forces of grips and on bodies over the step from `before` to `after`, which share a carriage.
void finish_step(const World& world, const Carriage& carriage, const State& before, const State& after, Real dt, StepReport& report);

/// Contact force [N] on each vertex of a surface, in magnitude: the barrier's forces of all its pairs, summed as vectors.
std::vector<Real> vertex_contact_force(const World& world, const std::vector<ContactPair>& pairs, const std::vector<Vec3>& x);
}  // namespace tape
