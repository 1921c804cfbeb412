#include "tape/solver/cholesky.hpp"

#include <cholmod.h>
#include <metis.h>

#include <algorithm>
#include <new>
#include <vector>

#include "tape/core/error.hpp"
#include "tape/solver/blas.hpp"

namespace tape {
namespace {
/// Nested dissection of the graph of 3x3 blocks.  @return new place -> block
std::vector<int> dissect(const HostBlocks& a) {
  const auto n = static_cast<std::size_t>(a.n);
  std::vector<idx_t> begin(n + 1, 0), perm(n), inverse(n);
  const auto for_edges = [&](auto&& f) {
    for (int i = 0; i < a.n; ++i)
      for (int k = a.row_begin[static_cast<std::size_t>(i)]; k < a.row_begin[static_cast<std::size_t>(i) + 1]; ++k)
        if (const int j = a.col[static_cast<std::size_t>(k)]; j != i) f(i, j), f(j, i);
  };
  for_edges([&](int i, int) { ++begin[static_cast<std::size_t>(i) + 1]; });
  for (std::size_t i = 0; i < n; ++i) begin[i + 1] += begin[i];
  std::vector<idx_t> neighbours(static_cast<std::size_t>(begin[n])), next(begin.begin(), begin.end() - 1);
  for_edges([&](int i, int j) { neighbours[static_cast<std::size_t>(next[static_cast<std::size_t>(i)]++)] = j; });
  idx_t options[METIS_NOPTIONS], vertices = a.n;
  METIS_SetDefaultOptions(options);
  options[METIS_OPTION_SEED] = 1;
  TAPE_CHECK(METIS_NodeND(&vertices, begin.data(), neighbours.data(), nullptr, options, perm.data(), inverse.data()) == METIS_OK);
  return {perm.begin(), perm.end()};
}
}  // namespace

struct Cholesky::Impl {
  cholmod_common common{};
  cholmod_factor* factor = nullptr;
  cholmod_sparse matrix{};  // lower triangle, columns compressed; a view of the vectors below
  std::vector<int> column_begin, row;
  std::vector<double> value;
  std::uint64_t pattern = 0;

  Impl() {
    cholmod_start(&common);
    common.print = 0;
    common.nmethods = 1;
    common.final_ll = 1;  // L L^T: an LDL^T would pass over negative pivots
    common.quick_return_if_not_posdef = 1;
  }
  ~Impl() {
    cholmod_free_factor(&factor, &common);
    cholmod_finish(&common);
  }

  void require_done() const {
    if (common.status == CHOLMOD_OUT_OF_MEMORY) throw std::bad_alloc();
    TAPE_CHECK(common.status >= CHOLMOD_OK);
  }

  /// Row i of the upper blocks is block column i of the lower triangle.
  template <class F>
  static void for_entries(const HostBlocks& a, F&& f) {
    for (int i = 0; i < a.n; ++i)
      for (int c = 0; c < 3; ++c)
        for (int k = a.row_begin[static_cast<std::size_t>(i)]; k < a.row_begin[static_cast<std::size_t>(i) + 1]; ++k)
          for (int r = a.col[static_cast<std::size_t>(k)] == i ? c : 0; r < 3; ++r) f(3 * i + c, static_cast<std::size_t>(k), r, c);
  }

  void set_pattern(const HostBlocks& a) {
    column_begin.assign(static_cast<std::size_t>(3 * a.n) + 1, 0);
    row.clear();
    for_entries(a, [&](int column, std::size_t k, int r, int) {
      row.push_back(3 * a.col[k] + r);
      column_begin[static_cast<std::size_t>(column) + 1] = static_cast<int>(row.size());
    });
    value.resize(row.size());
    matrix.nrow = matrix.ncol = static_cast<std::size_t>(3 * a.n);
    matrix.nzmax = row.size();
    matrix.p = column_begin.data();
    matrix.i = row.data();
    matrix.x = value.data();
    matrix.stype = -1;
    matrix.itype = CHOLMOD_INT;
    matrix.xtype = CHOLMOD_REAL;
    matrix.dtype = CHOLMOD_DOUBLE;
    matrix.sorted = matrix.packed = 1;
    order(a);
    pattern = a.pattern;
  }

  void order(const HostBlocks& a) {
    cholmod_free_factor(&factor, &common);
    common.supernodal = CHOLMOD_SIMPLICIAL;
    common.method[0].ordering = CHOLMOD_AMD;
    factor = cholmod_analyze(&matrix, &common);
    require_done();
    if (common.fl < kSupernodalRatio * common.lnz) return;
    cholmod_free_factor(&factor, &common);
    common.supernodal = CHOLMOD_SUPERNODAL;
    common.method[0].ordering = CHOLMOD_GIVEN;
    std::vector<int> places;
    for (int b : dissect(a)) places.insert(places.end(), {3 * b, 3 * b + 1, 3 * b + 2});
    factor = cholmod_analyze_p(&matrix, places.data(), nullptr, 0, &common);
    require_done();
  }
};

Cholesky::Cholesky() : impl_(std::make_unique<Impl>()) {}
Cholesky::~Cholesky() = default;
Cholesky::Cholesky(Cholesky&&) noexcept = default;
Cholesky& Cholesky::operator=(Cholesky&&) noexcept = default;

void Cholesky::analyze(const HostBlocks& a) { impl_->set_pattern(a); }

bool Cholesky::factor(const HostBlocks& a) {
  fix_blas_threads();
  if (impl_->pattern != a.pattern || a.pattern == 0) analyze(a);
  std::size_t entry = 0;
  Impl::for_entries(a, [&](int, std::size_t k, int r, int c) { impl_->value[entry++] = a.values[k](c, r); });
  cholmod_factorize(&impl_->matrix, impl_->factor, &impl_->common);
  if (impl_->common.status == CHOLMOD_NOT_POSDEF) return false;
  impl_->require_done();
  return true;
}

void Cholesky::solve(Span<const Vec3> b, Span<Vec3> x) {
  const auto n = static_cast<std::size_t>(3 * b.size);
  TAPE_CHECK(b.size == x.size && impl_->factor != nullptr && impl_->factor->n == n);
  cholmod_dense rhs{};
  rhs.nrow = rhs.nzmax = rhs.d = n;
  rhs.ncol = 1;
  rhs.x = const_cast<double*>(b.data->data());  // CHOLMOD has no const; it only reads
  rhs.xtype = CHOLMOD_REAL;
  rhs.dtype = CHOLMOD_DOUBLE;
  cholmod_dense* solution = cholmod_solve(CHOLMOD_A, impl_->factor, &rhs, &impl_->common);
  impl_->require_done();
  std::copy_n(static_cast<const double*>(solution->x), n, x.data->data());
  cholmod_free_dense(&solution, &impl_->common);
}

std::string_view Cholesky::name() const {
  return impl_->factor != nullptr && impl_->factor->is_super ? "cholesky_supernodal" : "cholesky_simplicial";
}
double Cholesky::factor_flops() const { return impl_->common.fl; }
double Cholesky::factor_nonzeros() const { return impl_->common.lnz; }
}  // namespace tape
