#include "tape/math/dihedral.hpp"

#include <gtest/gtest.h>

#include <numbers>

#include "tests/support/derivatives.hpp"
using namespace tape;

namespace {
/// Four vertices as 12 numbers and back.
struct Hinge {
  Vec3 x[4];
  explicit Hinge(const Eigen::VectorXd& q) {
    for (int k = 0; k < 4; ++k) x[k] = q.segment<3>(3 * k);
  }
};
/// Two triangles at an edge of 3 mm, folded by `angle`: the second apex rises above the first triangle. Off every axis.
Eigen::VectorXd folded(Real angle) {
  const Mat3 R = rotation_exp(Vec3(0.3, -0.8, 1.1));
  const Vec3 x[4] = {{0, 0, 0}, {3e-3, 0, 0}, {1e-3, 2e-3, 0}, {2.5e-3, -1.5e-3 * std::cos(angle), 1.5e-3 * std::sin(angle)}};
  Eigen::VectorXd q(12);
  for (int k = 0; k < 4; ++k) q.segment<3>(3 * k) = R * x[k] + Vec3(0.02, 0.01, -0.03);
  return q;
}
const Real kFolds[] = {0, 1e-6, 0.3, -0.3, 1.5, -1.5, 2.5, -2.5, 0.999 * std::numbers::pi, -0.999 * std::numbers::pi};
Real angle_at(const Eigen::VectorXd& q) { return dihedral(Hinge(q).x).angle; }
Eigen::VectorXd gradient_at(const Eigen::VectorXd& q) {
  const Dihedral d = dihedral(Hinge(q).x);
  Eigen::VectorXd g(12);
  for (int k = 0; k < 4; ++k) g.segment<3>(3 * k) = d.gradient[k];
  return g;
}
}  // namespace

TEST(Dihedral, TheAngleIsTheFold) {
  for (Real fold : kFolds) EXPECT_NEAR(angle_at(folded(fold)), fold, 1e-13);
}
TEST(Dihedral, TheGradientIsTheSlopeOfTheAngle) {
  for (Real fold : kFolds) {
    const Eigen::VectorXd q = folded(fold), g = gradient_at(q), slope = test::slope(angle_at, q, 5e-7);
    EXPECT_LT((g - slope).norm(), 1e-8 * g.norm()) << "fold " << fold;
  }
}
TEST(Dihedral, TheHessianIsTheSlopeOfTheGradient) {
  for (Real fold : kFolds) {
    const Eigen::VectorXd q = folded(fold);
    const MatN<12, 12> h = dihedral_hessian(Hinge(q).x);
    EXPECT_LT((h - test::jacobian(gradient_at, q, 5e-7)).norm(), 1e-7 * h.norm()) << "fold " << fold;
    EXPECT_LT((h - h.transpose()).norm(), 1e-13 * h.norm()) << "fold " << fold;
  }
}
