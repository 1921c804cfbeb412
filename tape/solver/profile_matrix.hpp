#pragma once
#include <vector>

#include "tape/core/types.hpp"

namespace tape {
/// A symmetric matrix of 3x3 blocks within a profile, and its Cholesky factor in its place. It is kept in panels of columns that reach
/// equally far down: a few wide rows, as a cut leaves where its cells are small, cost what they are and widen no other. One thread.
class ProfileMatrix {
 public:
  /// @param end  [blocks] one behind the last block that each row holds in the upper triangle: end[i] > i, nowhere less than before
  void set_profile(std::vector<int> end);
  int unknowns() const { return 3 * static_cast<int>(end_.size()); }
  bool holds(int i, int j) const { return j < end_[static_cast<std::size_t>(i)]; }  ///< block (i, j) of the upper triangle, i <= j
  void set_zero();
  /// Adds m^T to block (j, i) of the lower triangle, i <= j; holds(i, j).
  void add(int i, int j, const Mat3& m);
  /// @return false when the matrix is not positive definite
  bool factor();
  /// x = L^-1 x.  @param x  [unknowns], zero before `first_block`
  void solve_lower(Real* x, int first_block = 0) const;
  void solve_lower_transposed(Real* x) const;  ///< x = L^-T x.  @param x  [unknowns]

 private:
  struct Panel {
    std::size_t begin;  // in entries_: kPanel columns, each of `rows` entries
    int rows;           // counted from the diagonal entry of the first column
  };
  static constexpr int kPanel = 4;
  std::size_t place(int row, int column) const {
    const Panel& p = panels_[static_cast<std::size_t>(column / kPanel)];
    return p.begin + static_cast<std::size_t>(column % kPanel * p.rows + row - column / kPanel * kPanel);
  }
  std::vector<int> end_;
  std::vector<Panel> panels_;
  std::vector<Real> entries_;  // what a panel has above the diagonal is not read
};
}  // namespace tape
