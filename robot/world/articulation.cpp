#include "robot/world/articulation.hpp"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <cmath>

#include "robot/kinematics/forward_kinematics.hpp"
#include "robot/model/inertia.hpp"

namespace robot {
namespace {
Mat3 skew(const Vec3& a) {
  Mat3 s;
  s << 0, -a.z(), a.y(), a.z(), 0, -a.x(), -a.y(), a.x(), 0;
  return s;
}

/// Principal axes of a link's inertia, right-handed, and the moments about them.
std::pair<Mat3, Vec3> principal(const Mat3& inertia) {
  const Eigen::SelfAdjointEigenSolver<Mat3> eigen(inertia);
  Mat3 axes = eigen.eigenvectors();
  if (axes.determinant() < 0) axes.col(0) *= -1;
  return {axes, eigen.eigenvalues()};
}

void check(const RobotModel& model, bool fixed_base) {
  if (model.links.size() != model.joints.size() + 1) throw InputError("robot " + model.name + ": needs one link more than joints");
  for (std::size_t k = 0; k < model.links.size(); ++k) {
    const Inertial& i = model.links[k].inertial;
    if (k == 0 && fixed_base) continue;
    if (!(i.mass > 0 && std::isfinite(i.mass)))
      throw InputError(fmt::format("robot {}, link {}: mass = {:g} kg (allowed: > 0)", model.name, model.links[k].name, i.mass));
    if (!(principal_moments(i.inertia).minCoeff() > 0))
      throw InputError("robot " + model.name + ", link " + model.links[k].name + ": its inertia is not positive definite");
  }
  for (std::size_t k = 0; k < model.joints.size(); ++k) {
    const Joint& joint = model.joints[k];
    if (joint.parent < 0 || joint.parent > static_cast<int>(k))
      throw InputError("robot " + model.name + ", joint " + joint.name + ": its parent link does not come before its child");
    if (!(std::abs(joint.axis.norm() - 1) < 1e-6))
      throw InputError("robot " + model.name + ", joint " + joint.name + ": its axis is not a unit vector");
    if (!(joint.lower <= joint.upper))
      throw InputError("robot " + model.name + ", joint " + joint.name + ": its lower limit is above the upper");
  }
}
}  // namespace

Articulation::Articulation(int index, std::shared_ptr<const RobotModel> model, const Pose& X_WB, bool fixed_base)
    : model_(std::move(model)), fixed_base_(fixed_base) {
  check(*model_, fixed_base);
  for (const Link& link : model_->links) {
    const auto [axes, moments] = principal(link.inertial.inertia);
    Pose X_LC = Pose::Identity();
    X_LC.linear() = axes;
    X_LC.translation() = link.inertial.com;
    X_LC_.push_back(X_LC);
    moments_.push_back(moments);
  }
  X_WL_.resize(model_->links.size(), Pose::Identity());
  const Real mass = model_->links[0].inertial.mass;
  body_ = std::make_unique<btMultiBody>(static_cast<int>(joints()), mass, to_bullet(moments_[0]), fixed_base, false);
  for (int k = 0; k < joints(); ++k) setup_link(k);
  body_->finalizeMultiDof();
  body_->setLinearDamping(0);
  body_->setAngularDamping(0);
  body_->setMaxCoordinateVelocity(BT_LARGE_FLOAT);
  body_->setMaxAppliedImpulse(BT_LARGE_FLOAT);
  body_->setHasSelfCollision(true);
  for (int link = 0; link <= joints(); ++link) add_collider(index, link);
  set_base(X_WB);
  refresh();
}

void Articulation::setup_link(int k) {
  const Joint& joint = model_->joints[static_cast<std::size_t>(k)];
  const Real mass = model_->links[static_cast<std::size_t>(k) + 1].inertial.mass;
  const Pose X_CL = X_LC(k + 1).inverse(), X_CP = X_LC(joint.parent).inverse();
  const Mat3 R_from_parent = (X_CP.linear() * joint.X_PJ.linear() * X_LC(k + 1).linear()).transpose();
  const btQuaternion rotation = to_bullet(R_from_parent);
  const btVector3 axis = to_bullet(Vec3(X_CL.linear() * joint.axis));
  const btVector3 to_pivot = to_bullet(Vec3(X_CP * joint.X_PJ.translation()));
  const btVector3 to_com = to_bullet(Vec3(X_CL.linear() * X_LC(k + 1).translation()));
  const btVector3 moments = to_bullet(moments_[static_cast<std::size_t>(k) + 1]);
  if (joint.type == JointType::prismatic)
    body_->setupPrismatic(k, mass, moments, joint.parent - 1, rotation, axis, to_pivot, to_com, false);
  else
    body_->setupRevolute(k, mass, moments, joint.parent - 1, rotation, axis, to_pivot, to_com, false);
}

void Articulation::add_collider(int index, int link) {
  shapes_.push_back(std::make_unique<CollisionShape>(model_->links[static_cast<std::size_t>(link)], X_LC(link).inverse()));
  auto collider = std::make_unique<btMultiBodyLinkCollider>(body_.get(), link - 1);
  collider->setCollisionShape(&shapes_.back()->bullet());
  collider->setUserIndex(index);
  collider->setUserIndex2(link);
  collider->setActivationState(DISABLE_DEACTIVATION);
  if (link == 0)
    body_->setBaseCollider(collider.get());
  else
    body_->getLink(link - 1).m_collider = collider.get();
  colliders_.push_back(std::move(collider));
}

VecX Articulation::q() const {
  VecX q(joints());
  for (int k = 0; k < joints(); ++k) q[k] = body_->getJointPos(k);
  return q;
}

VecX Articulation::v() const {
  VecX v(dof());
  if (!fixed_base_) {
    const Vec3 omega = from_bullet(body_->getBaseOmega());
    const Vec3 to_com = X_WL(0).linear() * X_LC(0).translation();
    v << from_bullet(body_->getBaseVel()) - omega.cross(to_com), omega, VecX::Zero(joints());
  }
  for (int k = 0; k < joints(); ++k) v[base_dof() + k] = body_->getJointVel(k);
  return v;
}

void Articulation::set_base(const Pose& X_WB) { body_->setBaseWorldTransform(to_bullet(X_WB * X_LC(0))); }

void Articulation::set_q(const VecX& q) {
  for (int k = 0; k < joints(); ++k) body_->setJointPos(k, q[k]);
}

void Articulation::set_v(const VecX& v) {
  if (!fixed_base_) {
    const Vec3 omega = v.segment<3>(3), to_com = X_WL(0).linear() * X_LC(0).translation();
    body_->setBaseVel(to_bullet(Vec3(v.head<3>() + omega.cross(to_com))));
    body_->setBaseOmega(to_bullet(omega));
  }
  for (int k = 0; k < joints(); ++k) body_->setJointVel(k, v[base_dof() + k]);
}

void Articulation::save(std::vector<Real>& numbers) const {
  const btQuaternion& R = body_->getWorldToBaseRot();
  const btVector3& p = body_->getBasePos();
  numbers.insert(numbers.end(), {R.x(), R.y(), R.z(), R.w(), p.x(), p.y(), p.z()});
  for (int k = 0; k < joints(); ++k) numbers.push_back(body_->getJointPos(k));
  const btScalar* velocity = body_->getVelocityVector();
  numbers.insert(numbers.end(), velocity, velocity + 6 + joints());
}

void Articulation::restore(const Real*& n) {
  body_->setWorldToBaseRot({n[0], n[1], n[2], n[3]});
  body_->setBasePos({n[4], n[5], n[6]});
  n += 7;
  for (int k = 0; k < joints(); ++k) body_->setJointPos(k, *n++);
  body_->setBaseOmega({n[0], n[1], n[2]});
  body_->setBaseVel({n[3], n[4], n[5]});
  n += 6;
  for (int k = 0; k < joints(); ++k) body_->setJointVel(k, *n++);
  refresh();
}

void Articulation::refresh() {
  body_->forwardKinematics(scratch_q_, scratch_v_);
  body_->updateCollisionObjectWorldTransforms(scratch_q_, scratch_v_);
  X_WL_[0] = from_bullet(body_->getBaseWorldTransform()) * X_LC(0).inverse();
  for (int k = 0; k < joints(); ++k)
    X_WL_[static_cast<std::size_t>(k) + 1] = from_bullet(body_->getLink(k).m_cachedWorldTransform) * X_LC(k + 1).inverse();
}

/// Spatial velocity per unit speed of a joint, linear at the base frame's origin, then angular.
Articulation::Vec6 Articulation::joint_motion(int k) const {
  const Joint& joint = model_->joints[static_cast<std::size_t>(k)];
  const Vec3 axis = X_WL(k + 1).linear() * joint.axis;
  Vec6 s;
  if (joint.type == JointType::prismatic)
    s << axis, Vec3::Zero();
  else
    s << (X_WL(k + 1).translation() - X_WL(0).translation()).cross(axis), axis;
  return s;
}

MatX Articulation::jacobian(int link, const Vec3& p) const {
  MatX of_joints = robot::jacobian(*model_, X_WL_, link, p);
  if (fixed_base_) return of_joints;
  MatX J = MatX::Identity(6, dof());
  J.block<3, 3>(0, 3) = -skew(p - X_WL(0).translation());
  J.rightCols(joints()) = of_joints;
  return J;
}

/// Momentum, linear and about the base frame's origin, per spatial velocity there.
Articulation::Mat6 Articulation::spatial_inertia(int link) const {
  const Inertial& i = model_->links[static_cast<std::size_t>(link)].inertial;
  const Mat3 R = X_WL(link).linear();
  const Mat3 c = skew(X_WL(link) * i.com - X_WL(0).translation());
  Mat6 inertia;
  inertia << i.mass * Mat3::Identity(), -i.mass * c, i.mass * c, R * i.inertia * R.transpose() - i.mass * c * c;
  return inertia;
}

/// Composite rigid bodies [Featherstone 2008, sec. 6.2].
MatX Articulation::mass_matrix() const {
  const Eigen::Index b = base_dof();
  std::vector<Mat6> composite;
  std::vector<Vec6> motion;
  for (int link = 0; link <= joints(); ++link) composite.push_back(spatial_inertia(link));
  for (int k = 0; k < joints(); ++k) motion.push_back(joint_motion(k));
  MatX M = MatX::Zero(dof(), dof());
  for (int k = static_cast<int>(joints()) - 1; k >= 0; --k) {
    const std::size_t link = static_cast<std::size_t>(k) + 1;
    const Vec6 momentum = composite[link] * motion[link - 1];
    for (int j = k; j >= 0; j = model_->joints[static_cast<std::size_t>(j)].parent - 1)
      M(b + j, b + k) = M(b + k, b + j) = motion[static_cast<std::size_t>(j)].dot(momentum);
    if (b > 0) {
      M.block<6, 1>(0, b + k) = momentum;
      M.block<1, 6>(b + k, 0) = momentum.transpose();
    }
    composite[static_cast<std::size_t>(model_->joints[link - 1].parent)] += composite[link];
  }
  if (b > 0) M.topLeftCorner<6, 6>() = composite[0];
  return M;
}

MatX Articulation::to_bullet_velocity() const {
  MatX B = MatX::Zero(6 + joints(), dof());
  if (joints() > 0) B.bottomRightCorner(joints(), joints()).setIdentity();
  if (!fixed_base_) {
    B.block<3, 3>(0, 3).setIdentity();
    B.block<3, 3>(3, 0).setIdentity();
    B.block<3, 3>(3, 3) = -skew(X_WL(0).linear() * X_LC(0).translation());
  }
  return B;
}

Articulation::Vec6 Articulation::weight(const Vec3& gravity) const {
  Vec6 weight = Vec6::Zero();
  for (int link = 0; link <= joints(); ++link) {
    const Inertial& i = model_->links[static_cast<std::size_t>(link)].inertial;
    const Vec3 force = i.mass * gravity, arm = X_WL(link) * i.com - X_WL(0).translation();
    weight.head<3>() += force;
    weight.tail<3>() += arm.cross(force);
  }
  return weight;
}

VecX Articulation::joint_weight(const Vec3& gravity) const {
  std::vector<Real> mass;    // of a link and all beyond it
  std::vector<Vec3> moment;  // of these masses about the world's origin
  for (std::size_t link = 0; link < model_->links.size(); ++link) {
    const Inertial& i = model_->links[link].inertial;
    mass.push_back(i.mass), moment.push_back(i.mass * (X_WL_[link] * i.com));
  }
  VecX out(joints());
  for (Eigen::Index k = joints() - 1; k >= 0; --k) {
    const Joint& joint = model_->joints[static_cast<std::size_t>(k)];
    const std::size_t child = static_cast<std::size_t>(k) + 1, parent = static_cast<std::size_t>(joint.parent);
    const Vec3 axis = X_WL_[child].linear() * joint.axis, arm = moment[child] - mass[child] * X_WL_[child].translation();
    out[k] = joint.type == JointType::prismatic ? axis.dot(mass[child] * gravity) : axis.dot(arm.cross(gravity));
    mass[parent] += mass[child], moment[parent] += moment[child];
  }
  return out;
}

VecX Articulation::acceleration(const VecX& v, const VecX& tau, const Vec3& gravity) {
  set_v(v);
  body_->clearForcesAndTorques();
  body_->addBaseForce(to_bullet(Vec3(gravity * body_->getBaseMass())));
  for (int k = 0; k < joints(); ++k) body_->addLinkForce(k, to_bullet(Vec3(gravity * body_->getLinkMass(k))));
  if (!fixed_base_) {
    const Vec3 force = tau.head<3>(), to_com = X_WL(0).linear() * X_LC(0).translation();
    body_->addBaseForce(to_bullet(force));
    body_->addBaseTorque(to_bullet(Vec3(tau.segment<3>(3) - to_com.cross(force))));
  }
  for (int k = 0; k < joints(); ++k) body_->addJointTorque(k, tau[base_dof() + k]);
  body_->computeAccelerationsArticulatedBodyAlgorithmMultiDof(0, scratch_r_, scratch_v_, scratch_m_, false, false, false);
  body_->clearForcesAndTorques();
  const Eigen::Map<const VecX> a(&scratch_r_[static_cast<int>(joints())], 6 + joints());  // where Bullet leaves them
  VecX dv(dof());
  if (!fixed_base_) {
    const Vec3 to_com = X_WL(0).linear() * X_LC(0).translation(), domega = a.head<3>();
    dv << a.segment<3>(3) - domega.cross(to_com), domega, VecX::Zero(joints());
  }
  dv.tail(joints()) = a.tail(joints());
  return dv;
}
}  // namespace robot
