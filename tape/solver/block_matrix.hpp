#pragma once
#include <cstdint>
#include <vector>

#include "tape/core/side.hpp"
#include "tape/core/types.hpp"

namespace tape {
/// Key of a slot that contributes nothing, such as one of a vertex that is fixed.
inline constexpr std::uint64_t kNoBlock = ~std::uint64_t{0};
/// Key of block (row, col) of the upper triangle; row <= col is the caller's duty: H_ij with i > j is written as H_ij^T at (j, i).
TAPE_HD constexpr std::uint64_t block_key(int row, int col) {
  return static_cast<std::uint64_t>(row) << 32 | static_cast<std::uint64_t>(col);
}

/// The upper triangle on the host, rows and columns ascending: block k of row i has row_begin[i] <= k < row_begin[i + 1].
struct HostBlocks {
  int n = 0;                      ///< rows of 3x3 blocks
  std::vector<int> row_begin{0};  ///< [n+1]
  std::vector<int> col;           ///< [blocks]
  std::vector<Mat3> values;       ///< [blocks]
  std::vector<int> fixed;         ///< [blocks] which block of the fixed group it is, -1 if none
  std::vector<int> contact;       ///< [blocks] which block of the contact group it is, -1 if none
  std::uint64_t pattern = 0;      ///< BlockMatrix::pattern() it was made from
};
}  // namespace tape

namespace tape::TAPE_SIDE {
/// One entry of a full row. `ref` is twice the index of the stored block, plus one if it stands transposed.
struct RowEntry {
  int col;
  int ref;
};

/// Full rows (both triangles) of one group, columns ascending.
struct RowsView {
  Span<const int> begin;         ///< [n+1]
  Span<const RowEntry> entries;  ///< upper blocks twice, diagonal blocks once
  Span<const Mat3> values;       ///< [blocks] upper triangle
  TAPE_HD Vec3 row_times(int i, Span<const Vec3> x) const {
    Vec3 sum = Vec3::Zero();
    for (int e = begin[i]; e < begin[i + 1]; ++e) {
      const Mat3& m = values[entries[e].ref >> 1];
      const Vec3& v = x[entries[e].col];
      if (entries[e].ref & 1) {
        sum += m.transpose() * v;
      } else {
        sum += m * v;
      }
    }
    return sum;
  }
  TAPE_HD Mat3 entry(int e) const {
    const Mat3& m = values[entries[e].ref >> 1];
    return entries[e].ref & 1 ? Mat3(m.transpose()) : m;
  }
  TAPE_HD Mat3 block(int i, int j) const {
    for (int e = begin[i]; e < begin[i + 1]; ++e)
      if (entries[e].col == j) return entry(e);
    return Mat3::Zero();
  }
};

/// The matrix as kernels see it: the sum of its two groups.
struct MatrixView {
  RowsView fixed, contact;
  TAPE_HD Vec3 row_times(int i, Span<const Vec3> x) const { return fixed.row_times(i, x) + contact.row_times(i, x); }
  TAPE_HD Mat3 block(int i, int j) const { return fixed.block(i, j) + contact.block(i, j); }
};

/// Slots that are summed into the blocks of a symmetric matrix. A slot is a place that one element writes: its key once per
/// pattern, its 3x3 value once per evaluation. Every block lists its slots in ascending order, so its sum has one order.
class SlotGroup {
 public:
  /// @param keys           [slots] block_key(row, col) with row <= col < n, or kNoBlock
  /// @param with_diagonal  all n diagonal blocks exist, whether or not a slot writes them
  /// @return false when n and keys are those of the last call: then nothing was sorted
  bool set_pattern(int n, Span<const std::uint64_t> keys, bool with_diagonal);
  /// @param values  [slots]; a diagonal slot holds its whole symmetric block, an off-diagonal one H_ij, i < j
  void accumulate(Span<const Mat3> values);
  RowsView rows() const { return {row_begin_.span(), entries_.span(), values_.span()}; }
  int slots() const { return slot_keys_.size(); }
  int blocks() const { return values_.size(); }
  const Buffer<std::uint64_t>& keys() const { return block_keys_; }  ///< [blocks] ascending
  const Buffer<Mat3>& values() const { return values_; }             ///< [blocks]

 private:
  void find_blocks();
  void build_rows();
  int n_ = -1;
  Buffer<std::uint64_t> slot_keys_;    // [slots] as given
  Buffer<std::uint64_t> sorted_keys_;  // [slots, and n for the diagonal]
  Buffer<int> order_;                  // slot at each place of sorted_keys_
  Buffer<std::uint64_t> block_keys_;   // [blocks]
  Buffer<int> slot_begin_;             // [blocks+1] into order_
  Buffer<Mat3> values_;                // [blocks]
  Buffer<int> row_begin_;              // [n+1]
  Buffer<RowEntry> entries_;
};

/// Symmetric n x n matrix of 3x3 blocks as the sum of two groups of slots: `fixed` (inertia, elasticity, bodies: its pattern stays
/// for a run) and `contact` (its pattern follows the active pairs). A new contact pattern leaves the fixed group alone.
class BlockMatrix {
 public:
  void set_fixed_pattern(int n, Span<const std::uint64_t> keys);  ///< needed first; clears the contact group when n changes
  void set_contact_pattern(Span<const std::uint64_t> keys);
  void accumulate_fixed(Span<const Mat3> values) { fixed_.accumulate(values); }
  void accumulate_contact(Span<const Mat3> values) { contact_.accumulate(values); }
  int size() const { return n_; }
  int blocks() const { return fixed_.blocks() + contact_.blocks(); }
  MatrixView view() const { return {fixed_.rows(), contact_.rows()}; }
  const SlotGroup& fixed() const { return fixed_; }
  const SlotGroup& contact() const { return contact_; }
  /// Differs between any two patterns of the process, and stays while the keys stay.
  std::uint64_t pattern() const { return pattern_; }
  void multiply(Span<const Vec3> x, Span<Vec3> y) const;  ///< y = A x, each y_i summed by one iteration
  void diagonal(Span<Mat3> out) const;                    ///< [n] diagonal blocks
  void download_pattern(HostBlocks& host) const;          ///< rows, columns and sources; does nothing when `host` has this pattern
  void download(HostBlocks& host) const;                  ///< pattern and values

 private:
  int n_ = 0;
  std::uint64_t pattern_ = 0;
  SlotGroup fixed_, contact_;
};
}  // namespace tape::TAPE_SIDE
