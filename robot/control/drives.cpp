#include "robot/control/drives.hpp"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "robot/control/clamped_force.hpp"

namespace robot {
namespace {
void require_count(const std::string& robot, const char* what, std::size_t given, std::size_t joints) {
  if (given != joints) throw InputError(fmt::format("robot {}: {} {} for {} joints", robot, given, what, joints));
}
void require(bool good, const std::string& robot, const std::string& joint, const char* what, Real value, const char* range) {
  if (!good) throw InputError(fmt::format("robot {}, joint {}: {} = {:g} (allowed: {})", robot, joint, what, value, range));
}
}  // namespace

Drives::Drives(const RobotModel& model, const std::vector<DriveGains>& gains)
    : name_(model.name),
      gains_(gains),
      commands_(model.joints.size()),
      feed_forward_(VecX::Zero(static_cast<Eigen::Index>(model.joints.size()))),
      saturation_(model.joints.size(), 0) {
  if (gains.empty()) gains_.resize(model.joints.size());
  require_count(name_, "drive gains", gains_.size(), model.joints.size());
  for (std::size_t k = 0; k < gains_.size(); ++k) {
    DriveGains& g = gains_[k];
    const Joint& joint = model.joints[k];
    require(g.kp >= 0 && std::isfinite(g.kp), name_, joint.name, "kp", g.kp, "finite and >= 0");
    require(g.kd >= 0 && std::isfinite(g.kd), name_, joint.name, "kd", g.kd, "finite and >= 0");
    require(g.effort >= 0, name_, joint.name, "effort limit", g.effort, ">= 0");
    g.effort = std::min(g.effort, joint.effort);
    if (joint.mimic) g = {.effort = 0};
  }
}

void Drives::command(const std::vector<JointCommand>& commands) {
  require_count(name_, "commands", commands.size(), commands_.size());
  for (std::size_t k = 0; k < commands.size(); ++k)
    for (const Real value : {commands[k].position, commands[k].velocity, commands[k].effort})
      require(std::isfinite(value), name_, std::to_string(k), "command", value, "finite");
  commands_ = commands;
}

void Drives::feed_forward(const VecX& effort) {
  for (Eigen::Index k = 0; k < effort.size(); ++k) {
    const DriveGains& g = gains_[static_cast<std::size_t>(k)];
    feed_forward_[k] = g.kp > 0 || g.kd > 0 ? effort[k] : 0;
  }
}

DriveLaw Drives::unclamped(const VecX& q, Real h) const {
  const Eigen::Index n = q.size();
  DriveLaw law{VecX::Zero(n), VecX::Zero(n)};
  for (Eigen::Index k = 0; k < n; ++k) {
    const DriveGains& g = gains_[static_cast<std::size_t>(k)];
    const JointCommand& c = commands_[static_cast<std::size_t>(k)];
    const Real kp = c.kind == JointCommand::Kind::position ? g.kp : 0;
    const Real kd = c.kind == JointCommand::Kind::effort ? 0 : g.kd;
    const Real ahead = c.kind == JointCommand::Kind::effort ? 0 : feed_forward_[k];
    law.force[k] = kp * (c.position - q[k]) + kd * c.velocity + c.effort + ahead;
    law.damping[k] = kd + h * kp;
  }
  return law;
}

DriveLaw Drives::law(const VecX& q, Real h) const {
  DriveLaw law = unclamped(q, h);
  for (Eigen::Index k = 0; k < q.size(); ++k) {
    const std::size_t j = static_cast<std::size_t>(k);
    if (saturation_[j] == 0) continue;
    law.force[k] = saturation_[j] * gains_[j].effort;
    law.damping[k] = 0;
  }
  return law;
}

bool Drives::update_saturation(const VecX& q, const VecX& v, Real h, bool release) {
  const DriveLaw law = unclamped(q, h);
  bool changed = false;
  for (Eigen::Index k = 0; k < q.size(); ++k) {
    const std::size_t j = static_cast<std::size_t>(k);
    changed |= update_side(saturation_[j], law.force[k] - law.damping[k] * v[k], gains_[j].effort, release);
  }
  return changed;
}

VecX Drives::limits() const {
  VecX out(static_cast<Eigen::Index>(gains_.size()));
  for (std::size_t k = 0; k < gains_.size(); ++k) out[static_cast<Eigen::Index>(k)] = gains_[k].effort;
  return out;
}
VecX Drives::stiffness() const {
  VecX kp = VecX::Zero(static_cast<Eigen::Index>(gains_.size()));
  for (std::size_t k = 0; k < gains_.size(); ++k)
    if (saturation_[k] == 0 && commands_[k].kind == JointCommand::Kind::position) kp[static_cast<Eigen::Index>(k)] = gains_[k].kp;
  return kp;
}

VecX Drives::damping() const {
  VecX kd = VecX::Zero(static_cast<Eigen::Index>(gains_.size()));
  for (std::size_t k = 0; k < gains_.size(); ++k)
    if (saturation_[k] == 0 && commands_[k].kind != JointCommand::Kind::effort) kd[static_cast<Eigen::Index>(k)] = gains_[k].kd;
  return kd;
}

namespace {
/// Coordinates in groups that M couples, as the branches of a robot on a fixed base are not.
std::vector<std::vector<int>> coupled_groups(const MatX& M) {
  std::vector<std::vector<int>> groups;
  std::vector<bool> grouped(static_cast<std::size_t>(M.rows()), false);
  for (int first = 0; first < M.rows(); ++first) {
    if (grouped[static_cast<std::size_t>(first)]) continue;
    grouped[static_cast<std::size_t>(first)] = true;
    std::vector<int> group = {first};
    for (std::size_t i = 0; i < group.size(); ++i)
      for (int k = first + 1; k < M.rows(); ++k) {
        if (grouped[static_cast<std::size_t>(k)] || M(group[i], k) == 0) continue;
        grouped[static_cast<std::size_t>(k)] = true;
        group.push_back(k);
      }
    groups.push_back(std::move(group));
  }
  return groups;
}

MatX group_response(const MatX& M, const MatX& stiffness, const MatX& damping, Real h, int count) {
  const Eigen::LLT<MatX> lhs(M + h * damping + h * h * stiffness);
  MatX dx = MatX::Zero(M.rows(), M.cols()), dv = dx;
  for (int s = 0; s < count; ++s) {
    dv = lhs.solve(M * dv - h * stiffness * dx + h * MatX::Identity(M.rows(), M.cols()));
    dx += h * dv;
  }
  return (dx + dx.transpose()) / 2;
}
}  // namespace

MatX held_force_response(const MatX& M, const MatX& stiffness, const MatX& damping, Real h, int count) {
  MatX response = MatX::Zero(M.rows(), M.cols());
  for (const std::vector<int>& g : coupled_groups(M + stiffness + damping))
    response(g, g) = group_response(M(g, g), stiffness(g, g), damping(g, g), h, count);
  return response;
}
}  // namespace robot
