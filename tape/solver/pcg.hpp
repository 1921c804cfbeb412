#pragma once
#include "tape/core/side.hpp"
#include "tape/solver/block_matrix.hpp"
#include "tape/solver/linear_params.hpp"
#include "tape/solver/preconditioner.hpp"

namespace tape::TAPE_SIDE {
/// Preconditioned conjugate gradients from x = 0 [Hestenes 1952], stopped by EnergyErrorEstimate. Keeps its vectors.
class Pcg {
 public:
  /// Solves A x = b. Fills all of the report but `solver` and `relative_residual`. p' A p <= 0 ends it with `negative_curvature`.
  /// @param b, x  [n], memory of this side
  LinearReport solve(const BlockMatrix& a, Span<const Vec3> b, Span<Vec3> x, Preconditioner& m, Real tolerance, int max_iterations);

 private:
  Buffer<Vec3> r_, z_, p_, a_p_;
};
/// |b - A x| / |b|; 0 when b is 0
Real relative_residual(const BlockMatrix& a, Span<const Vec3> b, Span<const Vec3> x);
}  // namespace tape::TAPE_SIDE
