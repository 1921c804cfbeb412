#pragma once
#include <Eigen/Eigenvalues>

#include "tape/core/types.hpp"

namespace tape::test {
/// Derivative of f at x along each unit vector by central differences of fourth order; f returns Real or a fixed-size vector.
/// Row k holds that of component k of f.
template <class F>
Eigen::MatrixXd jacobian(const F& f, const Eigen::VectorXd& x, Real step) {
  const auto along = [&](Eigen::Index k, Real h) {
    Eigen::VectorXd y = x;
    y[k] += h;
    if constexpr (std::is_convertible_v<decltype(f(y)), Real>) {
      return Eigen::VectorXd(Eigen::VectorXd::Constant(1, f(y)));
    } else {
      return Eigen::VectorXd(f(y));
    }
  };
  Eigen::MatrixXd j;
  for (Eigen::Index k = 0; k < x.size(); ++k) {
    const Eigen::VectorXd d = (8 * (along(k, step) - along(k, -step)) - (along(k, 2 * step) - along(k, -2 * step))) / (12 * step);
    if (k == 0) j.resize(d.size(), x.size());
    j.col(k) = d;
  }
  return j;
}
/// Slope of a scalar function.
template <class F>
Eigen::VectorXd slope(const F& f, const Eigen::VectorXd& x, Real step) {
  return jacobian(f, x, step).transpose();
}

/// Closest positive semidefinite matrix to a symmetric one, by eigen-decomposition.
inline Eigen::MatrixXd psd_part(const Eigen::MatrixXd& m) {
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(m);
  return solver.eigenvectors() * solver.eigenvalues().cwiseMax(0).asDiagonal() * solver.eigenvectors().transpose();
}
inline Real smallest_eigenvalue(const Eigen::MatrixXd& m) {
  return Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(m, Eigen::EigenvaluesOnly).eigenvalues()[0];
}
}  // namespace tape::test
