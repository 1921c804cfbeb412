#include "tape/core/functors.hpp"
#include "tape/solver/preconditioner.hpp"

namespace tape::TAPE_SIDE {
namespace block_jacobi {
/// Inverse of a symmetric 3x3 matrix; `ok` is cleared when it is not positive definite (leading minors).
TAPE_HD inline Mat3 spd_inverse(const Mat3& m, bool& ok) {
  const Real minor2 = m(0, 0) * m(1, 1) - m(0, 1) * m(1, 0);
  ok = ok && m(0, 0) > 0 && minor2 > 0 && m.determinant() > 0;
  const Mat3 inverse = m.inverse();
  return 0.5 * (inverse + inverse.transpose());
}
struct Invert {  // returns how many blocks are not positive definite
  MatrixView a;
  Span<const int> partner;
  Span<Mat3> diagonal, coupling;
  TAPE_HD int operator()(int i) const {
    bool ok = true;
    const int j = partner[i];
    if (j < 0) {
      diagonal[i] = spd_inverse(a.block(i, i), ok);
    } else {  // by the Schur complement of the partner: [P Q; Q' R]^-1 has (P - Q R^-1 Q')^-1 at P
      const Mat3 q = a.block(i, j), r_inverse = spd_inverse(a.block(j, j), ok), q_r = q * r_inverse;
      diagonal[i] = spd_inverse(a.block(i, i) - q_r * q.transpose(), ok);
      coupling[i] = -diagonal[i] * q_r;
    }
    return ok ? 0 : 1;
  }
};
struct Apply {
  Span<const int> partner;
  Span<const Mat3> diagonal, coupling;
  Span<const Vec3> r;
  Span<Vec3> z;
  TAPE_HD void operator()(int i) const {
    Vec3 sum = diagonal[i] * r[i];
    if (partner[i] >= 0) sum += coupling[i] * r[partner[i]];
    z[i] = sum;
  }
};
}  // namespace block_jacobi

bool BlockJacobi::build(const BlockMatrix& a, Span<const Vec3>) {
  if (partner_.size() != a.size()) {
    std::vector<int> partner(static_cast<std::size_t>(a.size()), -1);
    for (int b : bodies_) {
      TAPE_CHECK(b >= 0 && b + 1 < a.size());
      partner[static_cast<std::size_t>(b)] = b + 1;
      partner[static_cast<std::size_t>(b) + 1] = b;
    }
    partner_.upload(partner);
    diagonal_.resize(a.size());
    coupling_.resize(a.size());
  }
  const block_jacobi::Invert invert{a.view(), partner_.span(), diagonal_.span(), coupling_.span()};
  return reduce(a.size(), 0, invert, Plus{}) == 0;
}

void BlockJacobi::apply(Span<const Vec3> r, Span<Vec3> z) {
  parallel_for(r.size, block_jacobi::Apply{partner_.span(), diagonal_.span(), coupling_.span(), r, z});
}

bool StripPreconditioner::build(const BlockMatrix& a, Span<const Vec3>) {
  a.download(host_);
  return factor_.factor(host_);
}
}  // namespace tape::TAPE_SIDE
