#pragma once
#include <Eigen/Core>
#include <vector>

#include "tape/core/types.hpp"

namespace tape {
/// A force on an articulation along one direction of its coordinates, proportional to how far they are ahead there, but not below `least`
/// nor above `most`: a drive with limits, dry friction that sticks, a joint's limit, a contact with what the tape side does not have.
struct LimitedSpring {
  Eigen::VectorXd along;     ///< [m]
  Real stiffness = 0;        ///< times dt^2, in units of the inertia
  Real least = 0, most = 0;  ///< [N]
};

/// What is known of an articulation for one step: a tree of links that somebody else simulates, and that the tape side may push off its
/// course. Its coordinates q [m] count from the start of the step; over the step the frame of link l moves by v = J_v q [m] and turns by
/// the rotation vector w = J_w q [rad] in the world.
/// Kinetic term, with e = q - predicted:
///   1/2 e' inertia e / dt^2 + sum over springs k of phi_k(a_k' e),   a_k = along,   phi_k' = stiffness_k a_k' e / dt^2 within the limits.
/// inertia + sum of stiffness a a' is what a force held over the step meets: dt^2 S^-1 with the response S = dq/df of links and all that
/// holds them (cosim/exchange/README.md). A spring that comes to its limit pushes on with that: its potential goes on linearly.
struct ArticulationStep {
  Eigen::VectorXd predicted;              ///< [m] change of q over the step when nothing on the tape side exerts a force
  Eigen::MatrixXd inertia;                ///< [m, m] symmetric positive definite
  std::vector<Eigen::MatrixXd> jacobian;  ///< [links][6, m] J_v, then J_w
  std::vector<LimitedSpring> springs = {};
};

/// What the tape side is told before a step about what somebody else simulates.
struct Exchange {
  std::vector<ArticulationStep> articulations;  ///< [Scene::articulations]
  std::vector<Index2> pinching;                 ///< pairs of bodies outside that touch here in this step, not there
};

/// Force and torque on a link, the torque about the origin of its frame.
struct Wrench {
  Vec3 force = Vec3::Zero();   ///< [N]
  Vec3 torque = Vec3::Zero();  ///< [N m]
};
/// What the tape side exerts on a link over a step, by what does it.
struct LinkReport {
  Wrench normal, friction, adhesion;
  Wrench hold;  ///< grips and axles
};
/// What became of an articulation in a step.
struct ArticulationReport {
  Eigen::VectorXd q;              ///< [m] change over the step
  Eigen::VectorXd force;          ///< [m] sum over links of J' times their wrenches, mean over the step
  std::vector<LinkReport> links;  ///< [links] mean over the step
};
}  // namespace tape
