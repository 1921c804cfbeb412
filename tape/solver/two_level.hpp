#pragma once
#include <vector>

#include "tape/core/side.hpp"
#include "tape/solver/block_matrix.hpp"
#include "tape/solver/cholesky.hpp"
#include "tape/solver/preconditioner.hpp"
#include "tape/solver/rigid_groups.hpp"

namespace tape::TAPE_SIDE {
/// The two 3x3 blocks of a row of P: a block moves by translation * t + rotation * w under the coordinates (t, w) of its group.
struct RigidModes {
  Real translation;
  Mat3 rotation;
};

/// Block Jacobi D plus an additive coarse space of the rigid motions of groups of rows and of bodies (README):
///   M^-1 = D^-1 + P (P' A P)^-1 P'
/// The columns of P are orthonormal for each group of a strip; a rotation that moves none of its points is left out. P' A P is a
/// BlockMatrix of two blocks per group, summed on this side and factored on the host; so two coarse vectors cross in each iteration.
class TwoLevel : public Preconditioner {
 public:
  explicit TwoLevel(const SystemLayout& layout);
  bool build(const BlockMatrix& a, Span<const Vec3> points) override;
  void apply(Span<const Vec3> r, Span<Vec3> z) override;

 private:
  /// Slots of P' A P that one group of slots of A makes: four per run, a run being what a row of A has in one coarse column.
  struct Slots {
    Buffer<int> run_begin;  // [n] runs in the rows before
    Buffer<std::uint64_t> keys;
    Buffer<Mat3> values;
  };
  void set_pattern(const BlockMatrix& a);
  void list_runs(RowsView rows, int first_slot, Slots& slots) const;
  void sum_runs(RowsView rows, int first_slot, Slots& slots) const;

  BlockJacobi jacobi_;
  std::vector<RigidGroup> layout_;
  Buffer<RigidGroup> groups_;
  Buffer<int> group_of_;      // [n]
  Buffer<RigidModes> modes_;  // [n]; unset where no group is
  std::uint64_t pattern_ = 0;
  Slots fixed_, contact_;  // the first [groups] fixed slots give the modes that are left out a diagonal of one
  BlockMatrix coarse_;
  HostBlocks coarse_host_;
  Cholesky cholesky_;
  Buffer<Vec3> coarse_r_, coarse_z_;  // [2 groups]
};
}  // namespace tape::TAPE_SIDE
