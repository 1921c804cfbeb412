#include "tape/solver/profile_matrix.hpp"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <random>
using namespace tape;

namespace {
/// A random positive definite matrix within a profile, dense and as a ProfileMatrix.
struct Both {
  Eigen::MatrixXd dense;
  ProfileMatrix profile;
};
Both random_matrix(const std::vector<int>& end, Real diagonal) {
  std::mt19937_64 generator(2);
  std::uniform_real_distribution<Real> u(-1, 1);
  const int n = static_cast<int>(end.size());
  Both m;
  m.dense.setZero(3 * n, 3 * n);
  m.profile.set_profile(end);
  m.profile.set_zero();
  for (int i = 0; i < n; ++i)
    for (int j = i; j < end[static_cast<std::size_t>(i)]; ++j) {
      Mat3 block = Mat3::NullaryExpr([&](Eigen::Index, Eigen::Index) { return u(generator); });
      if (i == j) block = Mat3(block + block.transpose() + diagonal * Mat3::Identity());
      m.dense.block<3, 3>(3 * i, 3 * j) = block;
      m.dense.block<3, 3>(3 * j, 3 * i) = block.transpose();
      m.profile.add(i, j, 0.25 * block), m.profile.add(i, j, 0.75 * block);
    }
  return m;
}
}  // namespace

TEST(ProfileMatrix, FactorsAndSolvesLikeADenseMatrix) {
  for (const std::vector<int>& end : {std::vector{1}, {2, 2}, {3, 3, 5, 5, 5}, {1, 2, 9, 9, 9, 9, 9, 9, 9, 10, 12, 12}}) {
    Both m = random_matrix(end, 60);
    const Eigen::LLT<Eigen::MatrixXd> llt(m.dense);
    ASSERT_EQ(llt.info(), Eigen::Success);
    ASSERT_TRUE(m.profile.factor());
    ASSERT_EQ(m.profile.unknowns(), m.dense.rows());
    const Eigen::VectorXd b = Eigen::VectorXd::LinSpaced(m.dense.rows(), -1, 2);
    Eigen::VectorXd x = b;
    m.profile.solve_lower(x.data());
    EXPECT_LT((x - llt.matrixL().solve(b)).norm(), 1e-13);
    m.profile.solve_lower_transposed(x.data());
    EXPECT_LT((m.dense * x - b).norm(), 1e-12);
    for (int first = 0; first < static_cast<int>(end.size()); ++first) {
      Eigen::VectorXd late = b, whole = b;
      late.head(3 * first).setZero(), whole.head(3 * first).setZero();
      m.profile.solve_lower(late.data(), first);
      m.profile.solve_lower(whole.data());
      EXPECT_EQ(late, whole) << first;
    }
  }
}

TEST(ProfileMatrix, HoldsWhatItsRowsReachAndSaysWhatIsNotPositiveDefinite) {
  Both m = random_matrix({2, 4, 4, 4}, 60);
  EXPECT_TRUE(m.profile.holds(0, 1) && m.profile.holds(1, 3));
  EXPECT_FALSE(m.profile.holds(0, 2));
  m.profile.add(2, 2, -200 * Mat3::Identity());
  EXPECT_FALSE(m.profile.factor());
  m.profile.set_profile({1, 2});
  m.profile.set_zero();
  EXPECT_EQ(m.profile.unknowns(), 6);
  for (int i = 0; i < 2; ++i) m.profile.add(i, i, 4 * Mat3::Identity());
  ASSERT_TRUE(m.profile.factor());
  Eigen::VectorXd x = Eigen::VectorXd::Ones(6);
  m.profile.solve_lower(x.data());
  EXPECT_EQ(x, Eigen::VectorXd::Constant(6, 0.5));
}
