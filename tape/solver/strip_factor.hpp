#pragma once
#include <vector>

#include "tape/core/types.hpp"
#include "tape/solver/block_matrix.hpp"
#include "tape/solver/linear_params.hpp"
#include "tape/solver/profile_matrix.hpp"

namespace tape {
/// Exact Cholesky factorisation of M, which is A without what lies outside the bands of its strips:
///   M = [ B  C ]   B = block diagonal of one band matrix per strip, C = couplings to the border (bodies and what no strip has),
///       [ C' D ]   factored as B = L L', W = L^-1 C, S = D - W' W = K K'.
/// The band of a strip is where its fixed group (elasticity) has entries, row by row; contact entries inside it are kept, those outside it
/// and those between strips are dropped (README). Host memory and one thread.
class StripFactor {
 public:
  explicit StripFactor(SystemLayout layout) : layout_(std::move(layout)) {}
  /// @return false when A is not positive definite
  bool factor(const HostBlocks& a);
  /// z = M^-1 r.  @param r, z  [n]
  void solve(Span<const Vec3> r, Span<Vec3> z);
  int dropped() const { return static_cast<int>(dropped_.size()); }  ///< blocks of the upper triangle that M lacks

 private:
  enum class Drop { lump, cut, compensate };
  struct Band {
    int first_block = 0;
    ProfileMatrix matrix;
  };
  void set_pattern(const HostBlocks& a);
  void fill(const HostBlocks& a, Drop drop);
  void add_diagonal(int block, const Mat3& m);
  bool factor_filled();
  bool in_band(int i, int j) const;

  SystemLayout layout_;
  std::uint64_t pattern_ = 0;
  std::vector<Band> bands_;
  std::vector<int> band_of_;        // [n] band of a block, -1: border
  std::vector<int> place_;          // [n] block's place in the concatenated strips, or in the border
  std::vector<int> touch_;          // [border blocks] place among those that couple to strips, -1: it does not
  std::vector<int> row_, dropped_;  // [blocks] row of each stored block; indices of the blocks left out
  std::vector<int> touched_;        // unknowns of the border that couple to strips, ascending
  std::vector<int> first_row_;      // [touched] block of the strips where their couplings begin
  int strip_unknowns_ = 0, border_unknowns_ = 0;
  std::vector<Real> coupling_;  // W [strip_unknowns, touched], column after column
  std::vector<Real> schur_;     // W' W [touched, touched], lower triangle, column after column
  std::vector<Real> border_;    // K, lower triangle, column after column
  std::vector<Real> strip_part_, border_part_, touched_part_;
};
}  // namespace tape
