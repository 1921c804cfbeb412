#include "tape/solver/strip_factor.hpp"

#include <cblas.h>
#include <lapacke.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

#include "tape/core/error.hpp"
#include "tape/solver/blas.hpp"

namespace tape {
namespace {
std::size_t at(int i) { return static_cast<std::size_t>(i); }

/// Widest reach of the fixed group inside blocks [first, end).
int fixed_width(const HostBlocks& a, int first, int end) {
  int width = 0;
  for (int i = first; i < end; ++i)
    for (int k = a.row_begin[at(i)]; k < a.row_begin[at(i) + 1]; ++k)
      if (a.fixed[at(k)] >= 0 && a.col[at(k)] < end) width = std::max(width, a.col[at(k)] - i);
  return width;
}

constexpr int kPanel = 4;  // columns that are eliminated together

/// L of a band matrix of n columns, in place of its lower triangle: column c begins with its diagonal entry at lower + c ld, where
/// ld = kd + kPanel, and ends with kPanel - 1 zeros, so that the columns of a panel reach equally far. LAPACK goes column by column
/// where kd <= 64 (dpbtrf) and takes three times as long.
/// @return false when the matrix is not positive definite
bool factor_band(Real* lower, int n, int kd) {
  using Column = Eigen::Map<Eigen::VectorXd>;
  using Four = Eigen::Map<Eigen::Vector4d>;
  const int ld = kd + kPanel;
  for (int j = 0; j < n; j += kPanel) {
    Real* const panel = lower + at(j) * at(ld);
    const auto entry = [&](int row, int column) { return panel + column * ld + row - column; };  // counted from j
    const int columns = std::min(kPanel, n - j);
    for (int q = 0; q < columns; ++q) {
      Column column(entry(q, q), ld - q);
      for (int p = 0; p < q; ++p) column -= *entry(q, p) * Column(entry(q, p), ld - q);
      if (!(column[0] > 0)) return false;
      column /= std::sqrt(column[0]);
    }
    for (int c = columns; c < std::min(ld, n - j); ++c) {
      Real *const l0 = entry(c, 0), *const l1 = entry(c, 1), *const l2 = entry(c, 2), *const l3 = entry(c, 3);
      const Real f0 = *l0, f1 = *l1, f2 = *l2, f3 = *l3;
      Real* const out = entry(c, c);
      int i = 0;
      for (; i + 4 <= ld - c; i += 4) Four(out + i) -= f0 * Four(l0 + i) + f1 * Four(l1 + i) + f2 * Four(l2 + i) + f3 * Four(l3 + i);
      for (; i < ld - c; ++i) out[i] -= f0 * l0[i] + f1 * l1[i] + f2 * l2[i] + f3 * l3[i];
    }
  }
  return true;
}
}  // namespace

void StripFactor::set_pattern(const HostBlocks& a) {
  bands_.resize(layout_.strips.size());
  band_of_.assign(at(a.n), -1);
  place_.assign(at(a.n), 0);
  strip_unknowns_ = border_unknowns_ = 0;
  for (std::size_t s = 0; s < bands_.size(); ++s) {
    const StripLayout& strip = layout_.strips[s];
    TAPE_CHECK(strip.first_block >= 0 && strip.first_block + strip.blocks <= a.n);
    for (int i = 0; i < strip.blocks; ++i) {
      band_of_[at(strip.first_block + i)] = static_cast<int>(s);
      place_[at(strip.first_block + i)] = strip_unknowns_ / 3 + i;
    }
    Band& band = bands_[s];  // its memory is used again
    band.first_block = strip.first_block;
    band.blocks = strip.blocks;
    band.width = fixed_width(a, strip.first_block, strip.first_block + strip.blocks);
    strip_unknowns_ += 3 * strip.blocks;
  }
  for (int i = 0; i < a.n; ++i)
    if (band_of_[at(i)] < 0) place_[at(i)] = border_unknowns_ / 3, border_unknowns_ += 3;
  row_.resize(a.col.size());
  dropped_.clear();
  for (int i = 0; i < a.n; ++i)
    for (int k = a.row_begin[at(i)]; k < a.row_begin[at(i) + 1]; ++k) {
      row_[at(k)] = i;
      const int band_i = band_of_[at(i)], band_j = band_of_[at(a.col[at(k)])];
      if (band_i < 0 || band_j < 0) continue;
      if (band_i != band_j || a.col[at(k)] - i > bands_[at(band_i)].width) dropped_.push_back(k);
    }
  strip_part_.resize(at(strip_unknowns_));
  border_part_.resize(at(border_unknowns_));
  pattern_ = a.pattern;
}

void StripFactor::add_diagonal(int block, const Mat3& m) {
  Band& band = bands_[at(band_of_[at(block)])];
  const int ld = band.kd() + kPanel, first = 3 * (block - band.first_block);
  for (int c = 0; c < 3; ++c)
    for (int r = c; r < 3; ++r) band.lower[at(first + c) * at(ld) + at(r - c)] += m(r, c);
}

void StripFactor::fill(const HostBlocks& a, Drop drop) {
  for (Band& band : bands_) band.lower.assign(at(band.unknowns()) * at(band.kd() + kPanel), 0);
  coupling_.assign(at(strip_unknowns_) * at(border_unknowns_), 0);
  border_.assign(at(border_unknowns_) * at(border_unknowns_), 0);
  for (int k = 0; k < static_cast<int>(row_.size()); ++k) {
    const int i = row_[at(k)], j = a.col[at(k)], band_i = band_of_[at(i)], band_j = band_of_[at(j)];
    const Mat3& m = a.values[at(k)];
    if (band_i >= 0 && band_j >= 0) {
      Band& band = bands_[at(band_i)];
      if (band_i != band_j || j - i > band.width) continue;
      for (int c = 0; c < 3; ++c)
        for (int r = i == j ? c : 0; r < 3; ++r)
          band.lower[at(3 * (i - band.first_block) + c) * at(band.kd() + kPanel) + at(3 * (j - i) + r - c)] = m(c, r);
    } else if (band_i < 0 && band_j < 0) {
      for (int c = 0; c < 3; ++c)
        for (int r = 0; r < 3; ++r) border_[at(3 * place_[at(i)] + c) * at(border_unknowns_) + at(3 * place_[at(j)] + r)] = m(c, r);
    } else {
      const bool row_in_strip = band_i >= 0;
      const int s = 3 * place_[at(row_in_strip ? i : j)], b = 3 * place_[at(row_in_strip ? j : i)];
      for (int c = 0; c < 3; ++c)
        for (int r = 0; r < 3; ++r) coupling_[at(b + c) * at(strip_unknowns_) + at(s + r)] = row_in_strip ? m(r, c) : m(c, r);
    }
  }
  if (drop == Drop::cut) return;
  for (int k : dropped_) {
    const Mat3& m = a.values[at(k)];
    const Mat3 share = drop == Drop::lump ? Mat3(0.5 * (m + m.transpose())) : Mat3(m.norm() * Mat3::Identity());
    add_diagonal(row_[at(k)], share);
    add_diagonal(a.col[at(k)], share);
  }
}

bool StripFactor::factor_filled() {
  const int ns = strip_unknowns_, nb = border_unknowns_;
  int first = 0;
  for (Band& band : bands_) {
    const int n = band.unknowns(), kd = band.kd();
    if (n == 0) continue;
    if (!factor_band(band.lower.data(), n, kd)) return false;
    if (nb > 0)
      LAPACKE_dtbtrs_work(LAPACK_COL_MAJOR, 'L', 'N', 'N', n, kd, nb, band.lower.data(), kd + kPanel, coupling_.data() + first, ns);
    first += n;
  }
  if (nb == 0) return true;
  if (ns > 0) cblas_dsyrk(CblasColMajor, CblasLower, CblasTrans, nb, ns, -1, coupling_.data(), ns, 1, border_.data(), nb);
  return LAPACKE_dpotrf_work(LAPACK_COL_MAJOR, 'L', nb, border_.data(), nb) == 0;
}

bool StripFactor::factor(const HostBlocks& a) {
  fix_blas_threads();
  if (pattern_ != a.pattern || a.pattern == 0) set_pattern(a);
  for (Drop drop : {Drop::lump, Drop::cut, Drop::compensate}) {
    fill(a, drop);
    if (factor_filled()) return true;
    if (dropped_.empty()) return false;
  }
  return false;  // M >= A after the last, so A is not positive definite either
}

void StripFactor::solve(Span<const Vec3> r, Span<Vec3> z) {
  const int ns = strip_unknowns_, nb = border_unknowns_;
  const auto part = [&](int i) { return (band_of_[at(i)] >= 0 ? strip_part_ : border_part_).data() + 3 * place_[at(i)]; };
  for (int i = 0; i < r.size; ++i) std::copy_n(r[i].data(), 3, part(i));
  const auto solve_bands = [&](CBLAS_TRANSPOSE transpose) {
    Real* x = strip_part_.data();
    for (const Band& band : bands_) {
      cblas_dtbsv(CblasColMajor, CblasLower, transpose, CblasNonUnit, band.unknowns(), band.kd(), band.lower.data(), band.kd() + kPanel, x,
                  1);
      x += band.unknowns();
    }
  };
  solve_bands(CblasNoTrans);
  if (nb > 0) {
    if (ns > 0) cblas_dgemv(CblasColMajor, CblasTrans, ns, nb, -1, coupling_.data(), ns, strip_part_.data(), 1, 1, border_part_.data(), 1);
    cblas_dtrsv(CblasColMajor, CblasLower, CblasNoTrans, CblasNonUnit, nb, border_.data(), nb, border_part_.data(), 1);
    cblas_dtrsv(CblasColMajor, CblasLower, CblasTrans, CblasNonUnit, nb, border_.data(), nb, border_part_.data(), 1);
    if (ns > 0)
      cblas_dgemv(CblasColMajor, CblasNoTrans, ns, nb, -1, coupling_.data(), ns, border_part_.data(), 1, 1, strip_part_.data(), 1);
  }
  solve_bands(CblasTrans);
  for (int i = 0; i < r.size; ++i) std::copy_n(part(i), 3, z[i].data());
}
}  // namespace tape
