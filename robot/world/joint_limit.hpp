#pragma once
#include "robot/world/bullet.hpp"

namespace robot {
/// Limits of a joint. Bullet's own act where they are passed, so that a joint that is pressed against one is without it in each substep
/// that starts at the limit to the last bit. These act from kReach before it on, where they let the joint come up to it.
class JointLimit final : public btMultiBodyJointLimitConstraint {
 public:
  using btMultiBodyJointLimitConstraint::btMultiBodyJointLimitConstraint;

  void createConstraintRows(btMultiBodyConstraintArray& rows, btMultiBodyJacobianData& data, const btContactSolverInfo& info) override {
    constexpr btScalar kReach = 1e-9;  // [rad or m]
    const btScalar q = m_bodyA->getJointPos(m_linkA), h = info.m_timeStep;
    const int first = rows.size();
    m_lowerBound += kReach, m_upperBound -= kReach;
    btMultiBodyJointLimitConstraint::createConstraintRows(rows, data, info);
    m_lowerBound -= kReach, m_upperBound += kReach;
    for (int i = first; i < rows.size(); ++i) {
      btMultiBodySolverConstraint& row = rows[i];
      const btScalar left = row.m_orgDofIndex == 0 ? q - m_lowerBound : m_upperBound - q;
      const btScalar made = (kReach - left) * info.m_erp / h, meant = left > 0 ? -left / h : -left * info.m_erp / h;
      row.m_rhs += (meant - made) * row.m_jacDiagABInv;
    }
  }
};
}  // namespace robot
