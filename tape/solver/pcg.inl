#include <cmath>

#include "tape/core/functors.hpp"
#include "tape/solver/error_estimate.hpp"
#include "tape/solver/pcg.hpp"

namespace tape::TAPE_SIDE {
namespace pcg {
struct Start {  // x = 0, r = b
  Span<const Vec3> b;
  Span<Vec3> x, r;
  TAPE_HD void operator()(int i) const {
    x[i] = Vec3::Zero();
    r[i] = b[i];
  }
};
struct Direction {  // p = z + beta p
  Real beta;
  Span<const Vec3> z;
  Span<Vec3> p;
  TAPE_HD void operator()(int i) const { p[i] = z[i] + beta * p[i]; }
};
struct FirstDirection {
  Span<const Vec3> z;
  Span<Vec3> p;
  TAPE_HD void operator()(int i) const { p[i] = z[i]; }
};
struct Curvature {  // a_p = A p; sums p' A p
  MatrixView a;
  Span<const Vec3> p;
  Span<Vec3> a_p;
  TAPE_HD Real operator()(int i) const {
    a_p[i] = a.row_times(i, p);
    return p[i].dot(a_p[i]);
  }
};
struct Advance {  // x += alpha p, r -= alpha A p
  Real alpha;
  Span<const Vec3> p, a_p;
  Span<Vec3> x, r;
  TAPE_HD void operator()(int i) const {
    x[i] += alpha * p[i];
    r[i] -= alpha * a_p[i];
  }
};
struct SquaredResidual {
  MatrixView a;
  Span<const Vec3> b, x;
  TAPE_HD Real operator()(int i) const { return (b[i] - a.row_times(i, x)).squaredNorm(); }
};
}  // namespace pcg

LinearReport Pcg::solve(const BlockMatrix& a, Span<const Vec3> b, Span<Vec3> x, Preconditioner& m, Real tolerance, int max_iterations) {
  const int n = a.size();
  TAPE_CHECK(b.size == n && x.size == n);
  for (Buffer<Vec3>* v : {&r_, &z_, &p_, &a_p_}) v->resize(n);
  const Span<Vec3> r = r_.span(), z = z_.span(), p = p_.span(), a_p = a_p_.span();
  LinearReport report;
  parallel_for(n, pcg::Start{b, x, r});
  report.dropped = m.dropped();
  m.apply(r, z);
  Real rho = reduce(n, Real{0}, Dot{r, z}, Plus{});
  if (rho == 0) {  // b = 0
    report.converged = true;
    return report;
  }
  parallel_for(n, pcg::FirstDirection{z, p});
  EnergyErrorEstimate estimate;
  while (report.iterations < max_iterations) {
    const Real curvature = reduce(n, Real{0}, pcg::Curvature{a.view(), p, a_p}, Plus{});
    if (!(curvature > 0) || !(rho > 0)) {
      report.negative_curvature = true;
      return report;
    }
    const Real alpha = rho / curvature;
    parallel_for(n, pcg::Advance{alpha, p, a_p, x, r});
    ++report.iterations;
    estimate.add(alpha * rho);
    report.error_estimate = estimate.relative();
    report.converged = report.error_estimate <= tolerance;
    if (report.converged) return report;
    m.apply(r, z);
    const Real rho_next = reduce(n, Real{0}, Dot{r, z}, Plus{});
    if (rho_next == 0) {  // solved to the bit
      report.error_estimate = 0;
      report.converged = true;
      return report;
    }
    parallel_for(n, pcg::Direction{rho_next / rho, z, p});
    rho = rho_next;
  }
  return report;
}

Real relative_residual(const BlockMatrix& a, Span<const Vec3> b, Span<const Vec3> x) {
  const Real b2 = reduce(b.size, Real{0}, Dot{b, b}, Plus{});
  const Real r2 = reduce(b.size, Real{0}, pcg::SquaredResidual{a.view(), b, x}, Plus{});
  return b2 > 0 ? std::sqrt(r2 / b2) : 0;
}
}  // namespace tape::TAPE_SIDE
