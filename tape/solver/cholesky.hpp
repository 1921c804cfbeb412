#pragma once
#include <memory>
#include <string_view>

#include "tape/core/types.hpp"
#include "tape/solver/block_matrix.hpp"

namespace tape {
/// Sparse Cholesky factorisation A = P^T L L^T P on the host, by CHOLMOD [Chen 2008].
/// AMD ordering and a simplicial factor where that takes less than kSupernodalRatio flops per entry of L (strips, reduced systems);
/// elsewhere (rolls) METIS nested dissection of the graph of 3x3 blocks and a supernodal factor. The ordering is a function of the pattern
/// alone; it is kept while the pattern stays, which changes no bits.
class Cholesky {
 public:
  static constexpr double kSupernodalRatio = 200;  ///< README: cost model
  Cholesky();
  ~Cholesky();
  Cholesky(Cholesky&&) noexcept;
  Cholesky& operator=(Cholesky&&) noexcept;
  /// Ordering and symbolic factorisation; factor() calls it when the pattern is a new one.
  void analyze(const HostBlocks& a);
  /// @return false when A is not positive definite
  bool factor(const HostBlocks& a);
  /// Assumes a successful factor().  @param b, x  [n], host memory
  void solve(Span<const Vec3> b, Span<Vec3> x);
  std::string_view name() const;  ///< "cholesky_simplicial" or "cholesky_supernodal"
  double factor_flops() const;    ///< of the last factorisation, by CHOLMOD's count
  double factor_nonzeros() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};
}  // namespace tape
