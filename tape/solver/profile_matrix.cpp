#include "tape/solver/profile_matrix.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <utility>

namespace tape {
namespace {
using Column = Eigen::Map<Eigen::VectorXd>;
using ConstColumn = Eigen::Map<const Eigen::VectorXd>;
using Four = Eigen::Map<Eigen::Vector4d>;
}  // namespace

void ProfileMatrix::set_profile(std::vector<int> end) {
  if (end == end_) return;
  end_ = std::move(end);
  panels_.clear();
  std::size_t size = 0;
  for (int first = 0; first < unknowns(); first += kPanel) {
    const int last = std::min(first + kPanel, unknowns()) - 1, rows = 3 * end_[static_cast<std::size_t>(last / 3)] - first;
    panels_.push_back({size, rows});
    size += static_cast<std::size_t>(kPanel * rows);
  }
  entries_.resize(size);
}

void ProfileMatrix::set_zero() { std::ranges::fill(entries_, 0); }

void ProfileMatrix::add(int i, int j, const Mat3& m) {
  for (int c = 0; c < 3; ++c) {
    Real* const column = entries_.data() + place(3 * j, 3 * i + c);
    for (int r = i == j ? c : 0; r < 3; ++r) column[r] += m(c, r);
  }
}

// LAPACK goes column by column where a band is narrower than 64 (dpbtrf) and takes three times as long.
bool ProfileMatrix::factor() {
  for (std::size_t p = 0; p < panels_.size(); ++p) {
    const int first = kPanel * static_cast<int>(p), rows = panels_[p].rows, columns = std::min(kPanel, unknowns() - first);
    const auto entry = [&](int row, int column) { return entries_.data() + panels_[p].begin + column * rows + row; };
    for (int q = 0; q < columns; ++q) {
      Column column(entry(q, q), rows - q);
      for (int k = 0; k < q; ++k) column -= *entry(q, k) * Column(entry(q, k), rows - q);
      if (!(column[0] > 0)) return false;
      column /= std::sqrt(column[0]);
    }
    for (int c = columns; c < rows; ++c) {
      Real *const l0 = entry(c, 0), *const l1 = entry(c, 1), *const l2 = entry(c, 2), *const l3 = entry(c, 3);
      const Real f0 = *l0, f1 = *l1, f2 = *l2, f3 = *l3;
      Real* const out = entries_.data() + place(first + c, first + c);
      int i = 0;
      for (; i + 4 <= rows - c; i += 4) Four(out + i) -= f0 * Four(l0 + i) + f1 * Four(l1 + i) + f2 * Four(l2 + i) + f3 * Four(l3 + i);
      for (; i < rows - c; ++i) out[i] -= f0 * l0[i] + f1 * l1[i] + f2 * l2[i] + f3 * l3[i];
    }
  }
  return true;
}

void ProfileMatrix::solve_lower(Real* x, int first_block) const {
  for (std::size_t p = static_cast<std::size_t>(3 * first_block / kPanel); p < panels_.size(); ++p) {
    const int rows = panels_[p].rows, columns = std::min(kPanel, unknowns() - kPanel * static_cast<int>(p));
    const Real* const l = entries_.data() + panels_[p].begin;
    Real* const y = x + kPanel * p;
    for (int q = 0; q < columns; ++q) {
      for (int k = 0; k < q; ++k) y[q] -= l[k * rows + q] * y[k];
      y[q] /= l[q * rows + q];
    }
    if (columns < kPanel) return;
    const auto below = [&](int q) { return ConstColumn(l + q * rows + kPanel, rows - kPanel); };
    Column(y + kPanel, rows - kPanel) -= y[0] * below(0) + y[1] * below(1) + y[2] * below(2) + y[3] * below(3);
  }
}

void ProfileMatrix::solve_lower_transposed(Real* x) const {
  for (std::size_t p = panels_.size(); p-- > 0;) {
    const int rows = panels_[p].rows, columns = std::min(kPanel, unknowns() - kPanel * static_cast<int>(p));
    const Real* const l = entries_.data() + panels_[p].begin;
    Real* const y = x + kPanel * p;
    for (int q = columns - 1; q >= 0; --q) {
      y[q] -= ConstColumn(l + q * rows + columns, rows - columns).dot(ConstColumn(y + columns, rows - columns));
      for (int k = q + 1; k < columns; ++k) y[q] -= l[q * rows + k] * y[k];
      y[q] /= l[q * rows + q];
    }
  }
}
}  // namespace tape
