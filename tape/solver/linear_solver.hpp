#pragma once
#include <map>
#include <memory>
#include <optional>
#include <vector>

#include "tape/core/side.hpp"
#include "tape/solver/block_matrix.hpp"
#include "tape/solver/cholesky.hpp"
#include "tape/solver/linear_params.hpp"
#include "tape/solver/pcg.hpp"

namespace tape::TAPE_SIDE {
/// What this side offers: on CUDA Cholesky runs on the host (the matrix crosses over), and there is no pcg_strip.
std::vector<LinearKind> available_solvers();

/// A x = b for symmetric A: one interface to all solvers. Keeps orderings while pattern and layout stay; the result is a function
/// of the arguments alone, to the bit, for any number of threads.
class LinearSolver {
 public:
  /// @throws SettingsError for a value out of range or a solver that this side does not offer
  explicit LinearSolver(LinearParams params, SystemLayout layout = {});
  void set_layout(SystemLayout layout);
  /// @param points  [n] m, position of each block of a strip; other entries are not read. Memory of this side, as b and x
  /// @param b, x    [n]; when the report says `negative_curvature`, x is not to be used
  LinearReport solve(const BlockMatrix& a, Span<const Vec3> points, Span<const Vec3> b, Span<Vec3> x);

 private:
  LinearKind kind(const BlockMatrix& a);
  LinearReport solve_cholesky(const BlockMatrix& a, Span<const Vec3> b, Span<Vec3> x);
  LinearReport solve_pcg(const BlockMatrix& a, Span<const Vec3> points, Span<const Vec3> b, Span<Vec3> x, LinearKind kind);
  Preconditioner& preconditioner(LinearKind kind);

  LinearParams params_;
  SystemLayout layout_;
  std::uint64_t chosen_for_ = 0;
  LinearKind chosen_ = LinearKind::automatic;
  HostBlocks host_;
  std::optional<Cholesky> cholesky_;
  std::map<LinearKind, std::unique_ptr<Preconditioner>> preconditioners_;
  Pcg pcg_;
  Buffer<Vec3> staging_;
};
}  // namespace tape::TAPE_SIDE
