#pragma once
#include <optional>

#include "robot/kinematics/joint_map.hpp"

namespace robot {
/// Where a frame should be. A weight of zero leaves that axis free: a rotation weight (1, 1, 0) aligns the z axes and lets the frame spin
/// about them.
struct FrameTarget {
  Frame frame;                          ///< of RobotModel::find_frame
  Pose X_WT = Pose::Identity();         ///< in the world
  Vec3 position_weight = Vec3::Ones();  ///< [1/m] along the target's axes
  Vec3 rotation_weight = Vec3::Ones();  ///< [1/rad] about the target's axes
};

struct IkOptions {
  Real position_tol = 1e-6;       ///< [m]
  Real rotation_tol = 1e-6;       ///< [rad]
  int max_iterations = 200;       ///< of one attempt, > 0
  int restarts = 30;              ///< attempts from random positions (fixed seed) after the first has failed; 0: stay near the start
  std::optional<VecX> rest = {};  ///< [nj] rad or m: among all solutions, prefer the nearest to these positions
};

/// What was found: where it has not converged, the attempt with the least weighted error.
struct IkResult {
  VecX q;                   ///< [nj] rad or m
  Real position_error = 0;  ///< [m] largest of all targets, over axes whose weight is not zero
  Real rotation_error = 0;  ///< [rad] likewise
  int iterations = 0;       ///< of all attempts together
  bool converged = false;   ///< both errors within tolerance
};

/// Joint positions that bring frames to their targets, by damped least squares with adaptive damping [Nakamura 1986] [Buss 2004]:
///   min over u in [lower, upper] of |r(u)|^2 / 2,   (J^T J + lambda 1) du = -J^T r,
/// r the weighted errors in the targets' axes: positions, and rotation vectors phi with exp(phi) = R_WT^T R_WF, whose exact slope
///   dphi = (1 - [phi]/2 + (1/|phi|^2 - cot(|phi|/2) / (2 |phi|)) [phi]^2) R_WT^T w_W
/// enters J. lambda falls tenfold when |r| falls and grows tenfold when not. A joint at its limit that would move out leaves the active
/// set of that step. Joints that carry no target stay at q_start. The rest posture acts in the null space of J alone: it never costs
/// accuracy.
/// An unreachable target is a value (converged false), not an exception.
/// @param q_start [nj] rad or m; moved into the limits first
/// @throws InputError if q_start or the rest posture is not of the model's size
IkResult solve_ik(const RobotModel& model, const std::vector<FrameTarget>& targets, const VecX& q_start, const IkOptions& options = {},
                  const Pose& X_WB = Pose::Identity());
}  // namespace robot
