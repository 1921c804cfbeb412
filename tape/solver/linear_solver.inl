#include <algorithm>
#include <cmath>

#include "tape/solver/cost_model.hpp"
#include "tape/solver/linear_solver.hpp"
#include "tape/solver/two_level.hpp"

namespace tape::TAPE_SIDE {
namespace linear_solver {
struct Copy {
  Span<const Vec3> from;
  Span<Vec3> to;
  TAPE_HD void operator()(int i) const { to[i] = from[i]; }
};
}  // namespace linear_solver

std::vector<LinearKind> available_solvers() {
  std::vector<LinearKind> kinds{LinearKind::cholesky, LinearKind::pcg_jacobi, LinearKind::pcg_two_level};
  if (kHostMemory) kinds.push_back(LinearKind::pcg_strip);
  return kinds;
}

LinearSolver::LinearSolver(LinearParams params, SystemLayout layout) : params_(params) {
  check(params_, kHostMemory);
  set_layout(std::move(layout));
}

void LinearSolver::set_layout(SystemLayout layout) {
  layout_ = std::move(layout);
  chosen_for_ = 0;
  preconditioners_.clear();
}

LinearKind LinearSolver::kind(const BlockMatrix& a) {
  if (params_.linear != LinearKind::automatic) return params_.linear;
  if (chosen_for_ != a.pattern()) {
    a.download_pattern(host_);
    chosen_ = choose(host_, layout_, kHostMemory);
    chosen_for_ = a.pattern();
  }
  return chosen_;
}

LinearReport LinearSolver::solve(const BlockMatrix& a, Span<const Vec3> points, Span<const Vec3> b, Span<Vec3> x) {
  TAPE_CHECK(b.size == a.size() && x.size == a.size());
  if (a.size() == 0) return {.solver = "none", .converged = true};
  const LinearKind which = kind(a);
  LinearReport report = which == LinearKind::cholesky ? solve_cholesky(a, b, x) : solve_pcg(a, points, b, x, which);
  if (!report.negative_curvature) {
    report.relative_residual = relative_residual(a, b, x);
    if (!std::isfinite(report.relative_residual)) report.converged = false;
  }
  return report;
}

LinearReport LinearSolver::solve_cholesky(const BlockMatrix& a, Span<const Vec3> b, Span<Vec3> x) {
  a.download(host_);
  if (!cholesky_) cholesky_.emplace();
  LinearReport report;
  report.negative_curvature = !cholesky_->factor(host_);
  report.converged = !report.negative_curvature;
  report.solver = cholesky_->name();
  if (!report.converged) return report;
  staging_.resize(b.size);
  parallel_for(b.size, linear_solver::Copy{b, staging_.span()});
  const std::vector<Vec3> rhs = staging_.download();
  std::vector<Vec3> solution(rhs.size());
  cholesky_->solve({rhs.data(), b.size}, {solution.data(), b.size});
  staging_.upload(solution);
  parallel_for(b.size, linear_solver::Copy{staging_.span(), x});
  return report;
}

Preconditioner& LinearSolver::preconditioner(LinearKind which) {
  std::unique_ptr<Preconditioner>& m = preconditioners_[which];
  if (m) return *m;
  if (which == LinearKind::pcg_strip) {
    m = std::make_unique<StripPreconditioner>(layout_);
  } else if (which == LinearKind::pcg_two_level) {
    m = std::make_unique<TwoLevel>(layout_);
  } else {
    m = std::make_unique<BlockJacobi>(layout_);
  }
  return *m;
}

LinearReport LinearSolver::solve_pcg(const BlockMatrix& a, Span<const Vec3> points, Span<const Vec3> b, Span<Vec3> x, LinearKind which) {
  Preconditioner& m = preconditioner(which);
  LinearReport report;
  if (m.build(a, points)) {
    report = pcg_.solve(a, b, x, m, params_.pcg_tol, params_.pcg_iterations);
  } else {
    report.negative_curvature = true;
  }
  report.solver = to_text(which);
  return report;
}
}  // namespace tape::TAPE_SIDE
