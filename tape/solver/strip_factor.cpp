#include "tape/solver/strip_factor.hpp"

#include <cblas.h>
#include <lapacke.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

#include "tape/core/error.hpp"
#include "tape/solver/blas.hpp"
#include "tape/solver/host_blocks.hpp"

namespace tape {
namespace {
std::size_t at(int i) { return static_cast<std::size_t>(i); }

}  // namespace

bool StripFactor::in_band(int i, int j) const {
  const int band = band_of_[at(i)];
  return band == band_of_[at(j)] && bands_[at(band)].matrix.holds(i - bands_[at(band)].first_block, j - bands_[at(band)].first_block);
}

void StripFactor::set_pattern(const HostBlocks& a) {
  bands_.resize(layout_.strips.size());  // their memory is used again
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
    bands_[s].first_block = strip.first_block;
    bands_[s].matrix.set_profile(fixed_profile(a, strip.first_block, strip.first_block + strip.blocks));
    strip_unknowns_ += 3 * strip.blocks;
  }
  for (int i = 0; i < a.n; ++i)
    if (band_of_[at(i)] < 0) place_[at(i)] = border_unknowns_ / 3, border_unknowns_ += 3;
  row_.resize(a.col.size());
  dropped_.clear();
  const int none = strip_unknowns_;
  std::vector<int> begin(at(border_unknowns_ / 3), none);  // of the couplings of each border block
  for (int i = 0; i < a.n; ++i)
    for (int k = a.row_begin[at(i)]; k < a.row_begin[at(i) + 1]; ++k) {
      row_[at(k)] = i;
      const int j = a.col[at(k)], band_i = band_of_[at(i)], band_j = band_of_[at(j)];
      if (band_i >= 0 && band_j >= 0) {
        if (!in_band(i, j)) dropped_.push_back(k);
      } else if (band_i >= 0 || band_j >= 0) {
        int& first = begin[at(place_[at(band_i >= 0 ? j : i)])];
        first = std::min(first, place_[at(band_i >= 0 ? i : j)]);
      }
    }
  touch_.assign(begin.size(), -1);
  touched_.clear(), first_row_.clear();
  for (int b = 0; b < static_cast<int>(begin.size()); ++b) {
    if (begin[at(b)] == none) continue;
    touch_[at(b)] = static_cast<int>(touched_.size());
    for (int c = 0; c < 3; ++c) touched_.push_back(3 * b + c), first_row_.push_back(begin[at(b)]);
  }
  strip_part_.resize(at(strip_unknowns_));
  border_part_.resize(at(border_unknowns_));
  touched_part_.resize(touched_.size());
  pattern_ = a.pattern;
}

void StripFactor::add_diagonal(int block, const Mat3& m) {
  Band& band = bands_[at(band_of_[at(block)])];
  band.matrix.add(block - band.first_block, block - band.first_block, m);
}

void StripFactor::fill(const HostBlocks& a, Drop drop) {
  for (Band& band : bands_) band.matrix.set_zero();
  coupling_.assign(at(strip_unknowns_) * touched_.size(), 0);
  border_.assign(at(border_unknowns_) * at(border_unknowns_), 0);
  for (int k = 0; k < static_cast<int>(row_.size()); ++k) {
    const int i = row_[at(k)], j = a.col[at(k)], band_i = band_of_[at(i)], band_j = band_of_[at(j)];
    const Mat3& m = a.values[at(k)];
    if (band_i >= 0 && band_j >= 0) {
      Band& band = bands_[at(band_i)];
      if (in_band(i, j)) band.matrix.add(i - band.first_block, j - band.first_block, m);
    } else if (band_i < 0 && band_j < 0) {
      for (int c = 0; c < 3; ++c)
        for (int r = 0; r < 3; ++r) border_[at(3 * place_[at(i)] + c) * at(border_unknowns_) + at(3 * place_[at(j)] + r)] = m(c, r);
    } else {
      const bool row_in_strip = band_i >= 0;
      const int s = 3 * place_[at(row_in_strip ? i : j)], b = touch_[at(place_[at(row_in_strip ? j : i)])];
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
  const int ns = strip_unknowns_, nb = border_unknowns_, nt = static_cast<int>(touched_.size());
  int first = 0;  // of the band, among the unknowns of the strips
  for (Band& band : bands_) {
    if (!band.matrix.factor()) return false;
    for (int t = 0; t < nt; ++t)
      if (first_row_[at(t)] * 3 < first + band.matrix.unknowns())
        band.matrix.solve_lower(coupling_.data() + at(t) * at(ns) + first, std::max(0, first_row_[at(t)] - first / 3));
    first += band.matrix.unknowns();
  }
  if (nb == 0) return true;
  if (ns > 0 && nt > 0) {
    schur_.resize(at(nt) * at(nt));
    cblas_dsyrk(CblasColMajor, CblasLower, CblasTrans, nt, ns, 1, coupling_.data(), ns, 0, schur_.data(), nt);
    for (int c = 0; c < nt; ++c)
      for (int r = c; r < nt; ++r) border_[at(touched_[at(c)]) * at(nb) + at(touched_[at(r)])] -= schur_[at(c) * at(nt) + at(r)];
  }
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
  const int ns = strip_unknowns_, nb = border_unknowns_, nt = static_cast<int>(touched_.size());
  const auto part = [&](int i) { return (band_of_[at(i)] >= 0 ? strip_part_ : border_part_).data() + 3 * place_[at(i)]; };
  for (int i = 0; i < r.size; ++i) std::copy_n(r[i].data(), 3, part(i));
  const auto for_bands = [&](auto&& f) {
    Real* x = strip_part_.data();
    for (const Band& band : bands_) f(band.matrix, x), x += band.matrix.unknowns();
  };
  for_bands([](const ProfileMatrix& m, Real* x) { m.solve_lower(x); });
  if (nb > 0) {
    if (nt > 0) {
      cblas_dgemv(CblasColMajor, CblasTrans, ns, nt, 1, coupling_.data(), ns, strip_part_.data(), 1, 0, touched_part_.data(), 1);
      for (int t = 0; t < nt; ++t) border_part_[at(touched_[at(t)])] -= touched_part_[at(t)];
    }
    cblas_dtrsv(CblasColMajor, CblasLower, CblasNoTrans, CblasNonUnit, nb, border_.data(), nb, border_part_.data(), 1);
    cblas_dtrsv(CblasColMajor, CblasLower, CblasTrans, CblasNonUnit, nb, border_.data(), nb, border_part_.data(), 1);
    if (nt > 0) {
      for (int t = 0; t < nt; ++t) touched_part_[at(t)] = border_part_[at(touched_[at(t)])];
      cblas_dgemv(CblasColMajor, CblasNoTrans, ns, nt, -1, coupling_.data(), ns, touched_part_.data(), 1, 1, strip_part_.data(), 1);
    }
  }
  for_bands([](const ProfileMatrix& m, Real* x) { m.solve_lower_transposed(x); });
  for (int i = 0; i < r.size; ++i) std::copy_n(part(i), 3, z[i].data());
}
}  // namespace tape
