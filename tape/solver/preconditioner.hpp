#pragma once
#include "tape/core/side.hpp"
#include "tape/solver/block_matrix.hpp"
#include "tape/solver/linear_params.hpp"
#include "tape/solver/strip_factor.hpp"

namespace tape::TAPE_SIDE {
/// z = M^-1 r with a symmetric positive definite M that is close to A.
class Preconditioner {
 public:
  virtual ~Preconditioner() = default;
  /// @param points  [n] m, position of each block of a strip; other entries are not read
  /// @return false when A is seen not to be positive definite
  virtual bool build(const BlockMatrix& a, Span<const Vec3> points) = 0;
  virtual void apply(Span<const Vec3> r, Span<Vec3> z) = 0;  ///< [n], memory of this side
  virtual int dropped() const { return 0; }                  ///< blocks of A that M lacks and the layout asked for
};

/// Inverses of the 3x3 diagonal blocks, and of the 6x6 ones of rigid bodies.
class BlockJacobi : public Preconditioner {
 public:
  explicit BlockJacobi(const SystemLayout& layout) : bodies_(layout.body_blocks) {}
  bool build(const BlockMatrix& a, Span<const Vec3>) override;
  void apply(Span<const Vec3> r, Span<Vec3> z) override;

 private:
  std::vector<int> bodies_;
  Buffer<int> partner_;    // [n] the other block of a rigid body, -1 for the rest
  Buffer<Mat3> diagonal_;  // [n] diagonal block of the inverse
  Buffer<Mat3> coupling_;  // [n] block of the inverse towards the partner
};

/// StripFactor as a preconditioner. Vectors cross to the host, so only the CPU side offers it.
class StripPreconditioner : public Preconditioner {
 public:
  explicit StripPreconditioner(const SystemLayout& layout) : factor_(layout) {}
  bool build(const BlockMatrix& a, Span<const Vec3>) override;
  void apply(Span<const Vec3> r, Span<Vec3> z) override { factor_.solve(r, z); }
  int dropped() const override { return factor_.dropped(); }

 private:
  HostBlocks host_;
  StripFactor factor_;
};
}  // namespace tape::TAPE_SIDE
