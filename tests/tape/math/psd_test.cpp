#include "tape/math/psd.hpp"

#include <gtest/gtest.h>

#include <random>

#include "tests/support/derivatives.hpp"
using namespace tape;

namespace {
/// Symmetric matrix with the given eigenvalues in a random frame.
template <int N>
MatN<N, N> with_eigenvalues(const VecN<N>& values, std::mt19937_64& generator) {
  std::normal_distribution<Real> normal;
  MatN<N, N> m;
  for (int i = 0; i < N; ++i)
    for (int j = 0; j < N; ++j) m(i, j) = normal(generator);
  const MatN<N, N> Q = Eigen::HouseholderQR<MatN<N, N>>(m).householderQ();
  const MatN<N, N> full = Q * values.asDiagonal() * Q.transpose();
  return 0.5 * (full + full.transpose());
}
const Vec3 kSpectra[] = {{1, 2, 3}, {-1, 2, 3}, {-3, -2, 1}, {-1, -2, -3},   {1, 1, 1},       {1, 1, -1},        {-1, -1, 5},
                         {0, 0, 1}, {0, 0, -1}, {0, 0, 0},   {1e-9, 1, 1e9}, {-1e-9, 1, 1e9}, {1, 1 + 1e-12, 2}, {-1e9, 1e-3, 1}};
}  // namespace

TEST(Psd, TheEigenDecompositionGivesTheMatrixBack) {
  std::mt19937_64 generator(1);
  for (const Vec3& values : kSpectra) {
    for (int k = 0; k < 20; ++k) {
      const Mat3 m = with_eigenvalues<3>(values, generator);
      const SymmetricEigen<3> e = symmetric_eigen(m);
      const Mat3 again = e.vectors * Vec3(e.value[0], e.value[1], e.value[2]).asDiagonal() * e.vectors.transpose();
      EXPECT_LE((again - m).norm(), 1e-14 * m.norm()) << values.transpose();
      EXPECT_LE((e.vectors * e.vectors.transpose() - Mat3::Identity()).norm(), 1e-14) << values.transpose();
    }
  }
}

TEST(Psd, ThePositivePartIsThatOfTheGenericEigenDecomposition) {
  std::mt19937_64 generator(2);
  for (const Vec3& values : kSpectra) {
    for (int k = 0; k < 20; ++k) {
      const Mat3 m = with_eigenvalues<3>(values, generator);
      EXPECT_LE((psd_part(m) - test::psd_part(m)).norm(), 1e-14 * m.norm()) << values.transpose();
      const Mat2 n = with_eigenvalues<2>(values.head<2>(), generator);
      EXPECT_LE((psd_part(n) - test::psd_part(n)).norm(), 1e-14 * n.norm()) << values.transpose();
    }
  }
}

TEST(Psd, APositiveMatrixIsLeftAsItIsToTheBit) {
  Mat3 m;
  m << 2, 0.5, 0.1, 0.5, 1, 0.2, 0.1, 0.2, 3;
  EXPECT_EQ(psd_part(m), m);
  EXPECT_EQ(psd_part(Mat2(m.topLeftCorner<2, 2>())), (m.topLeftCorner<2, 2>()));
}
