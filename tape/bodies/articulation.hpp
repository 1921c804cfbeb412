#pragma once
#include <Eigen/Core>
#include <vector>

#include "tape/core/types.hpp"

namespace tape {
/// What is known of an articulation for one step: a tree of links that somebody else simulates, and that the tape side may push off its
/// course. Its coordinates q [m] count from the start of the step; over the step the frame of link l moves by v = J_v q [m] and turns by
/// the rotation vector w = J_w q [rad] in the world.
/// Kinetic term, with e = q - predicted:
///   1/2 e' inertia e / dt^2 + sum over k of phi_k(e_k),   phi_k' = drive_k e_k / dt^2, but not below least_k nor above most_k.
/// inertia + diag(drive) is what a force held over the step meets: dt^2 S^-1 with the response S = dq/df of links and drives together
/// (cosim/exchange/README.md). A drive that comes to its limit pushes on with that: its potential goes on linearly. Likewise friction that
/// holds a joint, or a joint's limit.
struct ArticulationStep {
  Eigen::VectorXd predicted;                          ///< [m] change of q over the step when nothing on the tape side exerts a force
  Eigen::MatrixXd inertia;                            ///< [m, m] symmetric positive definite
  std::vector<Eigen::MatrixXd> jacobian;              ///< [links][6, m] J_v, then J_w
  Eigen::VectorXd drive = {}, least = {}, most = {};  ///< [m] or empty: none
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
