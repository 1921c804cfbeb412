#include "robot/control/inverse_kinematics.hpp"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include "robot/kinematics/forward_kinematics.hpp"

namespace robot {
namespace {
constexpr Real kDampingStart = 1e-3, kDampingMin = 1e-10, kDampingMax = 1e8;
constexpr Real kLargestStep = 0.5;        // [rad or m] of one joint in one iteration: the linearization holds no further
constexpr Real kLargestRestStep = 0.2;    // [rad or m] likewise, towards the rest posture
constexpr Real kRestTolerance = 1e-7;     // [rad or m]
constexpr Real kSmallestRestStep = 1e-3;  // fraction of the pull towards the rest posture

/// dphi = slope * w, both in the axes phi is given in; w the angular velocity there.
Mat3 rotation_vector_slope(const Vec3& phi) {
  const Real angle = phi.norm();
  Mat3 cross;
  cross << 0, -phi.z(), phi.y(), phi.z(), 0, -phi.x(), -phi.y(), phi.x(), 0;
  const Real c =
      angle > 1e-3 ? 1 / (angle * angle) - std::cos(angle / 2) / (2 * angle * std::sin(angle / 2)) : 1. / 12 + angle * angle / 720;
  return Mat3::Identity() - cross / 2 + c * cross * cross;
}

/// Errors of all targets and their slope by the independent joints, at some position of these.
struct Linearized {
  VecX r;  ///< [6 nt] weighted
  MatX J;  ///< [6 nt x nu]
  Real position_error = 0, rotation_error = 0;
  Real cost() const { return r.squaredNorm() / 2; }
};

struct Attempt {
  VecX u;  ///< [nu]
  Linearized at;
};

class Solver {
 public:
  Solver(const RobotModel& model, const std::vector<FrameTarget>& targets, const IkOptions& options, const Pose& X_WB)
      : model_(model), targets_(targets), options_(options), X_WB_(X_WB), map_(joint_map(model)) {
    VecX carries = VecX::Zero(model.joints.size());
    for (const FrameTarget& target : targets)
      for (int l = target.frame.link; l > 0; l = model.joints[l - 1].parent) carries[l - 1] = 1;
    const VecX moves = map_.map.cwiseAbs().transpose() * carries;
    for (Eigen::Index k = 0; k < moves.size(); ++k)
      if (moves[k] > 0) moving_.push_back(static_cast<int>(k));
  }

  IkResult solve(const VecX& q_start) {
    const VecX start = within(map_.independent_of(q_start));
    Attempt best = descend(start);
    std::mt19937_64 random(1);
    for (int attempt = 0; attempt < options_.restarts && !converged(best); ++attempt) {
      Attempt next = descend(random_start(start, random));
      if (converged(next) || next.at.cost() < best.at.cost()) best = std::move(next);
    }
    if (options_.rest && converged(best)) approach_rest(best, map_.independent_of(*options_.rest));
    return {map_.all(best.u), best.at.position_error, best.at.rotation_error, iterations_, converged(best)};
  }

 private:
  VecX within(const VecX& u) const { return u.cwiseMax(map_.lower).cwiseMin(map_.upper); }
  bool converged(const Attempt& a) const {
    return a.at.position_error <= options_.position_tol && a.at.rotation_error <= options_.rotation_tol;
  }

  Linearized linearize(const VecX& u) const {
    const auto nt = static_cast<Eigen::Index>(targets_.size());
    Linearized at{VecX(6 * nt), MatX(6 * nt, u.size())};
    const std::vector<Pose> X_WL = link_poses(model_, map_.all(u), X_WB_);
    for (Eigen::Index i = 0; i < nt; ++i) {
      const FrameTarget& target = targets_[i];
      const Pose X_WF = frame_pose(X_WL, target.frame);
      const Mat3 R_TW = target.X_WT.linear().transpose();
      const Vec3 offset = R_TW * (X_WF.translation() - target.X_WT.translation());
      const Eigen::AngleAxisd turn(R_TW * X_WF.linear());
      const Vec3 phi = turn.angle() * turn.axis();
      const Vec3 &wp = target.position_weight, &wr = target.rotation_weight;
      const MatX J_W = jacobian(model_, X_WL, target.frame.link, X_WF.translation()) * map_.map;
      at.r.segment<3>(6 * i) = wp.cwiseProduct(offset);
      at.r.segment<3>(6 * i + 3) = wr.cwiseProduct(phi);
      at.J.middleRows<3>(6 * i) = wp.asDiagonal() * R_TW * J_W.topRows<3>();
      at.J.middleRows<3>(6 * i + 3) = wr.asDiagonal() * rotation_vector_slope(phi) * R_TW * J_W.bottomRows<3>();
      at.position_error = std::max(at.position_error, (wp.array() != 0).select(offset, 0).norm());
      at.rotation_error = std::max(at.rotation_error, (wr.array() != 0).select(phi, 0).norm());
    }
    return at;
  }

  /// A step [nu] that only joints of the active set make: step_of(active) -> [active]. A joint at a limit that would leave it is taken
  /// out, and the others decide again.
  template <class StepOf>
  VecX active_step(const VecX& u, StepOf&& step_of) const {
    std::vector<int> active = moving_;
    while (!active.empty()) {
      const VecX step = step_of(active);
      std::vector<int> kept;
      for (std::size_t i = 0; i < active.size(); ++i) {
        const int k = active[i];
        const bool leaves = (u[k] >= map_.upper[k] && step[i] > 0) || (u[k] <= map_.lower[k] && step[i] < 0);
        if (!leaves) kept.push_back(k);
      }
      if (kept.size() == active.size()) {
        VecX du = VecX::Zero(u.size());
        du(active) = step;
        return du;
      }
      active = std::move(kept);
    }
    return VecX::Zero(u.size());
  }

  VecX damped_step(const Attempt& a, Real damping) const {
    return active_step(a.u, [&](const std::vector<int>& active) -> VecX {
      const MatX J = a.at.J(Eigen::all, active);
      MatX H = J.transpose() * J;
      H.diagonal().array() += damping;
      return H.llt().solve(-J.transpose() * a.at.r);
    });
  }

  /// Down to a solution or a least error near u.
  Attempt descend(const VecX& u) {
    Attempt a{u, linearize(u)};
    Real damping = kDampingStart;
    for (int i = 0; i < options_.max_iterations && !converged(a) && damping <= kDampingMax; ++i, ++iterations_) {
      const VecX du = damped_step(a, damping);
      const Real largest = du.lpNorm<Eigen::Infinity>();
      if (largest == 0) break;  // every joint is at a limit, or the error has no slope
      const VecX u_next = within(a.u + std::min(1., kLargestStep / largest) * du);
      Linearized next = linearize(u_next);
      if (next.cost() < a.at.cost()) {
        a = {u_next, std::move(next)};
        damping = std::max(damping / 10, kDampingMin);
      } else {
        damping *= 10;
      }
    }
    return a;
  }

  /// Moves along the solutions towards the rest posture: a step in the null space of J, then back onto the targets; kept if it came nearer.
  void approach_rest(Attempt& a, const VecX& rest) {
    Real fraction = 1;
    for (int i = 0; i < options_.max_iterations && fraction > kSmallestRestStep; ++i) {
      const VecX pull = active_step(a.u, [&](const std::vector<int>& active) -> VecX {
        const VecX wish = rest(active) - a.u(active);
        const MatX J = a.at.J(Eigen::all, active);
        return wish - J.completeOrthogonalDecomposition().solve(J * wish);
      });
      const Real largest = pull.lpNorm<Eigen::Infinity>();
      if (largest < kRestTolerance) return;
      Attempt next = descend(within(a.u + std::min(fraction, kLargestRestStep / largest) * pull));
      if (converged(next) && distance(next.u, rest) < distance(a.u, rest)) {
        a = std::move(next);
        fraction = std::min(1., 2 * fraction);
      } else {
        fraction /= 2;
      }
    }
  }
  Real distance(const VecX& u, const VecX& rest) const { return (u(moving_) - rest(moving_)).norm(); }

  /// Moving joints anywhere within their limits; joints without limits up to half a turn (1 m if they slide) from the start.
  VecX random_start(const VecX& start, std::mt19937_64& random) const {
    VecX u = start;
    for (int k : moving_) {
      const Real reach = model_.joints[map_.independent[k]].type == JointType::prismatic ? 1 : std::numbers::pi;
      const Real low = std::isfinite(map_.lower[k]) ? map_.lower[k] : start[k] - reach;
      const Real high = std::isfinite(map_.upper[k]) ? map_.upper[k] : start[k] + reach;
      u[k] = low + (high - low) * std::generate_canonical<Real, 53>(random);
    }
    return u;
  }

  const RobotModel& model_;
  const std::vector<FrameTarget>& targets_;
  const IkOptions& options_;
  Pose X_WB_;
  JointMap map_;
  std::vector<int> moving_;  ///< independent joints that carry a target
  int iterations_ = 0;
};

void require_size(const RobotModel& model, const VecX& q, const char* what) {
  if (q.size() != static_cast<Eigen::Index>(model.joints.size()))
    throw InputError(fmt::format("robot {}, inverse kinematics: {} has {} joint positions for {} joints", model.name, what, q.size(),
                                 model.joints.size()));
}
}  // namespace

IkResult solve_ik(const RobotModel& model, const std::vector<FrameTarget>& targets, const VecX& q_start, const IkOptions& options,
                  const Pose& X_WB) {
  require_size(model, q_start, "the start");
  if (options.rest) require_size(model, *options.rest, "the rest posture");
  return Solver(model, targets, options, X_WB).solve(q_start);
}
}  // namespace robot
