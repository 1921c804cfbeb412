#include "tape/bodies/relocation.hpp"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <cmath>
#include <vector>

#include "tape/math/rotation.hpp"
using namespace tape;

namespace {
/// A body (blocks 0 and 1) with vertices 0 and 1, a free vertex 2 (block 2) and a fixed vertex 3.
struct Fixture {
  std::vector<VertexOwner> owner = {{0, 0}, {0, 0}, {2, -1}, {-1, -1}};
  std::vector<Vec3> x = {{0.3, 0.1, -0.2}, {-0.1, 0.4, 0.2}, {0.5, -0.3, 0.1}, {0, 0, 1}};
  std::vector<Pose> body = {{Mat3::Identity(), Vec3(0.1, 0.05, 0.02)}};
  StateView view() const {
    StateView s{};
    s.x = {x.data(), 4};
    s.owner = {owner.data(), 4};
    s.body = {body.data(), 1};
    return s;
  }
  /// Positions after the unknowns change by q: translation, rotation, free vertex.
  VecN<12> moved(const VecN<9>& q) const {
    VecN<12> out;
    for (int i = 0; i < 2; ++i)
      out.segment<3>(3 * i) =
          rotation_exp(q.segment<3>(3)) * (x[static_cast<std::size_t>(i)] - body[0].position) + body[0].position + q.head<3>();
    out.segment<3>(6) = x[2] + q.tail<3>();
    out.segment<3>(9) = x[3];
    return out;
  }
};
// A quartic of all coordinates, so that gradient and Hessian are full and not constant.
const VecN<12> kA = VecN<12>::LinSpaced(-0.4, 0.9), kB = VecN<12>::LinSpaced(0.7, -0.3);
Real energy(const VecN<12>& x) { return std::pow(kA.dot(x), 4) + std::pow(kB.dot(x), 2) * kA.dot(x) + x.squaredNorm(); }
VecN<12> gradient(const VecN<12>& x) {
  const Real a = kA.dot(x), b = kB.dot(x);
  return (4 * a * a * a + b * b) * kA + 2 * a * b * kB + 2 * x;
}
MatN<12, 12> hessian(const VecN<12>& x) {
  const Real a = kA.dot(x), b = kB.dot(x);
  const MatN<12, 12> cross = 2 * b * kA * kB.transpose();
  return 12 * a * a * kA * kA.transpose() + cross + cross.transpose() + 2 * a * kB * kB.transpose() + 2 * MatN<12, 12>::Identity();
}
Eigen::Matrix<Real, 9, 9> assembled(const Relocation<4>& r, const Mat3* blocks) {
  Eigen::Matrix<Real, 9, 9> H;
  for (int a = 0; a < 3; ++a)
    for (int b = a; b < 3; ++b) {
      H.block<3, 3>(3 * r.block[a], 3 * r.block[b]) = blocks[pair_slot(a, b, 3)];
      H.block<3, 3>(3 * r.block[b], 3 * r.block[a]) = blocks[pair_slot(a, b, 3)].transpose();
    }
  return H;
}
}  // namespace

TEST(Relocation, FixedVerticesHaveNoBlockAndVerticesOfABodyShareTheirs) {
  const Relocation<4> r = relocate(Stencil<4>{{0, 1, 2, 3}}, Fixture{}.view());
  EXPECT_EQ(r.blocks, 3);
  EXPECT_EQ(r.slot[0], r.slot[1]);
  EXPECT_EQ(r.slot[3], -1);
}

TEST(Relocation, GradientAndHessianAreTheSlopesAlongTheUnknowns) {
  const Fixture f;
  const Relocation<4> r = relocate(Stencil<4>{{0, 1, 2, 3}}, f.view());
  const VecN<12> x = f.moved(VecN<9>::Zero());
  Vec3 g[8];
  Mat3 H[36];
  relocate_gradient(r, gradient(x), g);
  relocate_hessian(r, gradient(x), hessian(x), true, H);
  const auto value = [&](const VecN<9>& q) { return energy(f.moved(q)); };
  const Real h = 1e-4;
  Eigen::Matrix<Real, 9, 9> slope2;
  for (int i = 0; i < 9; ++i) {
    const VecN<9> ei = h * VecN<9>::Unit(i);
    EXPECT_NEAR(g[i / 3][i % 3], (value(ei) - value(-ei)) / (2 * h), 1e-7) << "unknown " << i;
    for (int j = 0; j < 9; ++j) {
      const VecN<9> ej = h * VecN<9>::Unit(j);
      slope2(i, j) = (value(ei + ej) - value(ei - ej) - value(ej - ei) + value(-ei - ej)) / (4 * h * h);
    }
  }
  EXPECT_LT((assembled(r, H) - slope2).norm(), 1e-5);
}

TEST(Relocation, WithoutTheSecondOrderTermAPositiveHessianStaysPositive) {
  const Fixture f;
  const Relocation<4> r = relocate(Stencil<4>{{0, 1, 2, 3}}, f.view());
  Mat3 H[36];
  relocate_hessian(r, VecN<12>(VecN<12>::Constant(-50)), MatN<12, 12>(MatN<12, 12>::Identity()), false, H);
  EXPECT_GT((Eigen::SelfAdjointEigenSolver<Eigen::Matrix<Real, 9, 9>>(assembled(r, H)).eigenvalues().minCoeff()), 0);
}
