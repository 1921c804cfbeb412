#include "robot/world/driven_robot.hpp"

#include <Eigen/Cholesky>
#include <cmath>

namespace robot {
DrivenRobot::DrivenRobot(int index, std::shared_ptr<const RobotModel> model, const RobotParams& params)
    : drive_impulse(VecX::Zero(static_cast<Eigen::Index>(model->joints.size()))),
      body_(index, model, params.X_WB, params.fixed_base),
      drives_(*model, params.drives),
      joint_map_(joint_map(*model)),
      compensate_gravity_(params.compensate_gravity),
      viscous_(body_.joints()) {
  for (Eigen::Index k = 0; k < body_.joints(); ++k) viscous_[k] = model->joints[static_cast<std::size_t>(k)].damping;
  motions_ = MatX::Identity(body_.dof(), body_.base_dof() + joint_map_.map.cols());
  motions_.bottomRightCorner(joint_map_.map.rows(), joint_map_.map.cols()) = joint_map_.map;
  body_.bullet().setUserPointer(this);
  add_constraints();
  body_.set_q(follow(VecX::Zero(body_.joints())));
  body_.refresh();
  for (int link = 0; link <= body_.joints(); ++link) set_friction(link, params.friction);
}

void DrivenRobot::add_constraints() {
  for (int k = 0; k < body_.joints(); ++k) {
    const Joint& joint = body_.model().joints[static_cast<std::size_t>(k)];
    if (joint.friction > 0) constraints_.push_back(std::make_unique<btMultiBodyJointMotor>(&body_.bullet(), k, 0, 0));
    if (std::isinf(joint.lower) && std::isinf(joint.upper)) continue;
    constraints_.push_back(std::make_unique<btMultiBodyJointLimitConstraint>(&body_.bullet(), k, joint.lower, joint.upper));
    constraints_.back()->setMaxAppliedImpulse(BT_LARGE_FLOAT);
  }
}

MatX DrivenRobot::on_joints(const VecX& diagonal) const {
  VecX all = VecX::Zero(body_.dof());
  all.tail(diagonal.size()) = diagonal;
  return all.asDiagonal();
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
  for (const int side : drives_.saturation()) numbers.push_back(side);
}

void DrivenRobot::restore(const Real*& n) {
  body_.restore(n);
  std::vector<JointCommand> commands;
  for (Eigen::Index k = 0; k < body_.joints(); ++k, n += 4)
    commands.push_back({static_cast<JointCommand::Kind>(static_cast<int>(n[0])), n[1], n[2], n[3]});
  drives_.command(commands);
  std::vector<int> saturation;
  for (Eigen::Index k = 0; k < body_.joints(); ++k) saturation.push_back(static_cast<int>(*n++));
  drives_.set_saturation(saturation);
}

MatX DrivenRobot::response(Real h, int count, bool drives) const {
  const MatX stiffness = on_joints(drives * drives_.stiffness()), damping = on_joints(drives * drives_.damping() + viscous_);
  const auto reduced = [&](const MatX& A) -> MatX { return motions_.transpose() * A * motions_; };
  const MatX S = held_force_response(reduced(body_.mass_matrix()), reduced(stiffness), reduced(damping), h, count);
  return motions_ * S * motions_.transpose();
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
  for (const auto& constraint : constraints_)
    if (constraint->getConstraintType() == MULTIBODY_CONSTRAINT_1DOF_JOINT_MOTOR)
      constraint->setMaxAppliedImpulse(h * body_.model().joints[static_cast<std::size_t>(constraint->getLinkA())].friction);
}

void DrivenRobot::move_freely() {
  constexpr int kMidpoints = 3;  // evaluations of the Coriolis forces at the mean velocity: an error of (h omega)^3
  law_ = drives_.law(q_, h_);
  const MatX K = M_ + h_ * on_joints(law_.damping + viscous_);
  give_ = motions_ * MatX(motions_.transpose() * K * motions_).llt().solve(motions_.transpose());
  const MatX B = body_.to_bullet_velocity();
  impulse_response_ = B * give_ * B.transpose();

  VecX drive = VecX::Zero(body_.dof());
  drive.tail(body_.joints()) = h_ * law_.force;
  v_free_ = v_start_;
  for (int i = 0; i < kMidpoints; ++i) {
    const VecX a = body_.acceleration((v_start_ + v_free_) / 2, tau_, gravity_);
    v_free_ = give_ * (M_ * (v_start_ + h_ * a) + drive);
  }
  body_.set_v(v_free_);
}

bool DrivenRobot::update_saturation(bool release) {
  v_end_ = body_.v();
  return drives_.update_saturation(q_, v_end_.tail(body_.joints()), h_, release);
}

void DrivenRobot::set_drift() {
  if (body_.base_dof() == 0) return;
  const VecX a = body_.acceleration((v_start_ + v_end_) / 2, VecX::Zero(body_.dof()), Vec3::Zero());
  VecX v = v_end_;
  v.head<6>() -= h_ / 2 * (give_ * (M_ * a)).head<6>();
  body_.set_v(v);
}

void DrivenRobot::end() {
  drive_impulse += h_ * (law_.force - law_.damping.cwiseProduct(v_end_.tail(body_.joints())));
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
