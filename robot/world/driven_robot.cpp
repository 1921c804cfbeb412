#include "robot/world/driven_robot.hpp"

#include <cmath>
#include <limits>

#include "robot/world/joint_limit.hpp"

namespace robot {
DrivenRobot::DrivenRobot(int index, const std::shared_ptr<const RobotModel>& model, const RobotParams& params)
    : drive_impulse(VecX::Zero(static_cast<Eigen::Index>(model->joints.size()))),
      friction_impulse(drive_impulse),
      limit_impulse(drive_impulse),
      body_(index, model, params.X_WB, params.fixed_base),
      drives_(*model, params.drives),
      friction_(*model),
      joint_map_(joint_map(*model)),
      compensate_gravity_(params.compensate_gravity),
      viscous_(body_.joints()) {
  for (Eigen::Index k = 0; k < body_.joints(); ++k) viscous_[k] = model->joints[static_cast<std::size_t>(k)].damping;
  motions_ = MatX::Identity(body_.dof(), body_.base_dof() + joint_map_.map.cols());
  motions_.bottomRightCorner(joint_map_.map.rows(), joint_map_.map.cols()) = joint_map_.map;
  body_.bullet().setUserPointer(this);
  add_limits();
  body_.set_q(follow(VecX::Zero(body_.joints())));
  body_.refresh();
  for (int link = 0; link <= body_.joints(); ++link) set_friction(link, params.friction);
}

void DrivenRobot::add_limits() {
  for (int k = 0; k < body_.joints(); ++k) {
    const Joint& joint = body_.model().joints[static_cast<std::size_t>(k)];
    if (std::isinf(joint.lower) && std::isinf(joint.upper)) continue;
    constraints_.push_back(std::make_unique<JointLimit>(&body_.bullet(), k, joint.lower, joint.upper));
    constraints_.back()->setMaxAppliedImpulse(BT_LARGE_FLOAT);
    constraints_.back()->finalizeMultiDof();  // Bullet does so when it first acts; we ask for its impulse before
  }
}

MatX DrivenRobot::on_joints(const VecX& diagonal) const {
  VecX all = VecX::Zero(body_.dof());
  all.tail(diagonal.size()) = diagonal;
  return all.asDiagonal();
}

/// T^T A T: what the motions that mimicking joints leave see of A.
MatX DrivenRobot::independent(const MatX& A) const { return motions_.cols() == motions_.rows() ? A : motions_.transpose() * A * motions_; }

/// Change of velocity by an impulse, both [dof].
VecX DrivenRobot::give(const VecX& impulse) const { return motions_ * K_.solve(motions_.transpose() * impulse); }

const MatX& DrivenRobot::impulse_response() {
  if (impulse_response_.size() > 0) return impulse_response_;
  const MatX BT = body_.to_bullet_velocity() * motions_;
  return impulse_response_ = BT * K_.solve(BT.transpose());
}

VecX DrivenRobot::follow_velocity(const VecX& v) const {
  VecX result = v;
  result.tail(body_.joints()) = joint_map_.map * joint_map_.independent_of(v.tail(body_.joints()));
  return result;
}

/// Bullet multiplies both links' coefficients.
void DrivenRobot::set_friction(int link, Real mu) { body_.collider(link).setFriction(std::sqrt(mu)); }

void DrivenRobot::save(std::vector<Real>& numbers) const {
  body_.save(numbers);
  for (const JointCommand& c : drives_.commands())
    numbers.insert(numbers.end(), {static_cast<Real>(c.kind), c.position, c.velocity, c.effort});
  for (const std::vector<int>* active : {&drives_.saturation(), &friction_.slipping()})
    numbers.insert(numbers.end(), active->begin(), active->end());
}

void DrivenRobot::restore(const Real*& n) {
  body_.restore(n);
  std::vector<JointCommand> commands;
  for (Eigen::Index k = 0; k < body_.joints(); ++k, n += 4)
    commands.push_back({static_cast<JointCommand::Kind>(static_cast<int>(n[0])), n[1], n[2], n[3]});
  drives_.command(commands);
  const auto active = [&] {
    std::vector<int> set;
    for (Eigen::Index k = 0; k < body_.joints(); ++k) set.push_back(static_cast<int>(*n++));
    return set;
  };
  drives_.set_saturation(active());
  friction_.set_slipping(active());
}

MatX DrivenRobot::response(Real h, int count, bool drives) const {
  const MatX stiffness = on_joints(drives * drives_.stiffness()), damping = on_joints(drives * drives_.damping() + viscous_);
  const MatX S = held_force_response(independent(body_.mass_matrix()), independent(stiffness), independent(damping), h, count);
  return motions_ * S * motions_.transpose();
}

/// Friction holds a joint where all that moves with it and has friction sticks; a limit, where it has acted in the step or the joint stands
/// at it.
std::vector<JointHold> DrivenRobot::holds(Real dt) const {
  constexpr Real kAny = std::numeric_limits<Real>::infinity();
  constexpr Real kAt = 1e-5;  // [rad or m]
  const VecX q = body_.q();
  std::vector<JointHold> holds(joint_map_.independent.size());
  for (std::size_t u = 0; u < holds.size(); ++u) {
    JointHold& hold = holds[u];
    Real friction = 0, exerted = 0;
    bool sticks = true;
    for (Eigen::Index k = 0; k < q.size(); ++k) {
      const Real share = joint_map_.map(k, static_cast<Eigen::Index>(u));
      if (share == 0) continue;
      const Joint& joint = body_.model().joints[static_cast<std::size_t>(k)];
      friction += std::abs(share) * friction_.friction()[k];
      exerted += share * friction_impulse[k] / dt;
      sticks &= friction_.friction()[k] == 0 || friction_.slipping()[static_cast<std::size_t>(k)] == 0;
      hold.effort += share * limit_impulse[k] / dt;
      if (limit_impulse[k] > 0 || q[k] <= joint.lower + kAt) (share > 0 ? hold.most : hold.least) = std::copysign(kAny, share);
      if (limit_impulse[k] < 0 || q[k] >= joint.upper - kAt) (share > 0 ? hold.least : hold.most) = std::copysign(kAny, -share);
    }
    hold.stopped = hold.least < hold.most;
    if (sticks && friction > 0) hold.effort += exerted, hold.least -= friction, hold.most += friction;
  }
  return holds;
}

void DrivenRobot::begin(const VecX& tau, const Vec3& gravity, Real h) {
  h_ = h;
  gravity_ = gravity;
  tau_ = tau;
  q_ = body_.q();
  v_start_ = body_.v();
  origin_ = body_.X_WL(0).translation();
  weight_ = body_.weight(gravity);
  M_ = body_.mass_matrix();
  if (compensate_gravity_) {
    VecX carried = VecX::Zero(body_.joints());
    carried(joint_map_.independent) = -joint_map_.map.transpose() * body_.joint_weight(gravity);
    drives_.feed_forward(carried);
  }
}

void DrivenRobot::move_freely() {
  constexpr int kMidpoints = 3;  // evaluations of the Coriolis forces at the mean velocity: an error of (h omega)^3
  law_ = drives_.law(q_, h_);
  friction_law_ = friction_.law();
  K_.compute(independent(M_ + h_ * on_joints(law_.damping + friction_law_.damping + viscous_)));
  impulse_response_.resize(0, 0);
  for (const auto& limit : constraints_)  // Bullet leaves the impulses of rows that it does not make
    for (int row = 0; row < limit->getNumRows(); ++row) limit->internalSetAppliedImpulse(row, 0);

  VecX drive = VecX::Zero(body_.dof());
  drive.tail(body_.joints()) = h_ * (law_.force + friction_law_.force);
  v_free_ = v_start_;
  for (int i = 0; i < kMidpoints; ++i) {
    const VecX a = body_.acceleration((v_start_ + v_free_) / 2, tau_, gravity_);
    v_free_ = give(M_ * (v_start_ + h_ * a) + drive);
  }
  body_.set_v(v_free_);
}

bool DrivenRobot::update_active_sets(bool release) {
  v_end_ = body_.v();
  const VecX joints = v_end_.tail(body_.joints());
  const bool driven = drives_.update_saturation(q_, joints, h_, release), slipping = friction_.update(joints, release);
  return driven || slipping;
}

void DrivenRobot::set_drift() {
  if (body_.base_dof() == 0) return;
  const VecX a = body_.acceleration((v_start_ + v_end_) / 2, VecX::Zero(body_.dof()), Vec3::Zero());
  VecX v = v_end_;
  v.head<6>() -= h_ / 2 * give(M_ * a).head<6>();
  body_.set_v(v);
}

void DrivenRobot::end() {
  const VecX joints = v_end_.tail(body_.joints());
  drive_impulse += h_ * (law_.force - law_.damping.cwiseProduct(joints));
  friction_impulse += h_ * (friction_law_.force - friction_law_.damping.cwiseProduct(joints));
  for (const auto& limit : constraints_) limit_impulse[limit->getLinkA()] += limit->getAppliedImpulse(0) - limit->getAppliedImpulse(1);
  body_.refresh();
  if (body_.base_dof() == 0) return;
  Eigen::Matrix<Real, 6, 1> momentum = (M_ * (v_start_ + v_end_ - v_free_) + h_ * tau_).head<6>() + h_ * weight_;
  momentum.tail<3>() += (origin_ - body_.X_WL(0).translation()).cross(momentum.head<3>());
  const MatX M = body_.mass_matrix();
  VecX v = v_end_;
  v.head<6>() += M.topLeftCorner<6, 6>().llt().solve(momentum - (M * v).head<6>());
  body_.set_v(v);
}
}  // namespace robot
