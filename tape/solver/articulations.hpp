#pragma once
#include <vector>

#include "tape/bodies/articulation.hpp"
#include "tape/bodies/assembly.hpp"
#include "tape/core/side.hpp"
#include "tape/solver/block_matrix.hpp"
#include "tape/solver/energy_sum.hpp"
#include "tape/solver/linear_solver.hpp"

namespace tape::TAPE_SIDE {
/// One of the two blocks of a link, translation or rotation, and how it follows the coordinates: [3, 3 count] J in `count` pieces.
struct LinkBlock {
  int block;         ///< among the unknowns
  int articulation;  ///< which it belongs to
  int jacobian;      ///< place of the first piece
};
/// One articulation.
struct QBlocks {
  int first, count;             ///< its blocks, counted from the first of all articulations
  int solved;                   ///< first of its blocks in the solved system
  int inertia;                  ///< place of the first piece of its inertia / dt^2, [count, count], row after row
  int first_link, link_blocks;  ///< its blocks of links
};
/// A LimitedSpring (tape/bodies/articulation.hpp), by how far the coordinates are ahead along it.
struct Spring {
  Real stiffness, least, most;
  int articulation;
  int along;  ///< place of the first piece of its direction, as many as the articulation has blocks
  TAPE_HD Real force(Real ahead) const { return std::fmin(std::fmax(stiffness * ahead, least), most); }
  TAPE_HD Real energy(Real ahead) const {
    const Real f = force(ahead);
    return stiffness > 0 ? f * (ahead - f / (2 * stiffness)) : 0;
  }
  /// Which limit is reached: -1 the least, 1 the most, 0 none.
  TAPE_HD int side(Real ahead) const { return stiffness * ahead < least ? -1 : stiffness * ahead > most ? 1 : 0; }
  TAPE_HD Real slope(Real ahead) const { return side(ahead) == 0 ? stiffness : 0; }
};
/// All springs on the host, by how far all coordinates are ahead.
struct HostSprings {
  std::vector<Spring> springs;
  Eigen::MatrixXd along;  ///< [coordinates of all articulations' blocks, springs]
  /// Sum over springs of their direction times f(spring, how far ahead).
  template <class F>
  Eigen::VectorXd sum(const Eigen::VectorXd& ahead, const F& f) const {
    return along * each(ahead, f);
  }
  template <class F>
  Eigen::VectorXd each(const Eigen::VectorXd& ahead, const F& f) const {
    Eigen::VectorXd out = along.transpose() * ahead;
    for (std::size_t k = 0; k < springs.size(); ++k) out[static_cast<Eigen::Index>(k)] = f(springs[k], out[static_cast<Eigen::Index>(k)]);
    return out;
  }
  Eigen::VectorXd force(const Eigen::VectorXd& ahead) const {
    return sum(ahead, [](const Spring& s, Real a) { return s.force(a); });
  }
  Eigen::VectorXd side(const Eigen::VectorXd& ahead) const {
    return each(ahead, [](const Spring& s, Real a) { return Real(s.side(a)); });
  }
  /// What the springs' slopes where the coordinates are `ahead` make of a change of them.
  Eigen::VectorXd stiffness(const Eigen::VectorXd& ahead, const Eigen::VectorXd& change) const {
    const Eigen::VectorXd slope = each(ahead, [](const Spring& s, Real a) { return s.slope(a); });
    return along * slope.cwiseProduct(along.transpose() * change);
  }
};
/// Where the blocks of unknowns stand in the system that is solved.
struct FoldView {
  Span<const int> solved;  ///< [n] block there; -1 - k for block k of links
  Span<const LinkBlock> links;
  Span<const QBlocks> articulations;
  Span<const Mat3> jacobian, inertia;
  Span<const Spring> springs;    ///< of one articulation after the other
  Span<const int> first_spring;  ///< [articulations + 1]
  Span<const Vec3> along;
  TAPE_HD const LinkBlock* link(int block) const { return solved[block] < 0 ? &links[-1 - solved[block]] : nullptr; }
  TAPE_HD const QBlocks& of(const LinkBlock& l) const { return articulations[l.articulation]; }
};

/// Articulations in the solver. The potential is written on the frames of the links, six unknowns each. They follow the coordinates,
/// du = J dq, which leaves, beside all that is no link,
///   (J' H J + inertia / dt^2) dq = -(J' g + inertia (q - target) / dt^2).
class Articulations {
 public:
  /// @param blocks  of the unknowns, as Assembly numbers them
  explicit Articulations(const Assembly& assembly);
  bool any() const { return !parts_.empty(); }
  int q_blocks() const { return q_blocks_; }
  /// Numbers the solved system, when there are so many blocks of unknowns. @return its layout, from that of the unknowns
  SystemLayout set_layout(const SystemLayout& unknowns, int blocks);
  /// What holds for a step or a part of it.
  /// @param target  [articulations][m] where q is at its end if nothing on the tape side exerts a force
  void begin(const std::vector<ArticulationStep>& steps, const std::vector<Eigen::VectorXd>& target, Real dt);
  EnergySum energy(Span<const Vec3> q);
  /// Solves for the unknowns' Newton direction x, to the minimum of what is a parabola between the limits of the springs. The right side b,
  /// minus the gradient, becomes that by what is solved for: 0 at links.
  /// @param points   [n] m, position of each block of a strip
  /// @param limited  false: as if the springs had no limits
  LinearReport solve(LinearSolver& linear, const BlockMatrix& a, Span<const Vec3> points, Span<const Vec3> q, bool limited, Span<Vec3> b,
                     Span<Vec3> x);
  /// Coordinates [articulations][m] from blocks [q blocks].
  std::vector<Eigen::VectorXd> coordinates(const std::vector<Vec3>& q) const;

 private:
  struct Folded {  // the slots of one group
    Buffer<int> offset;
    Buffer<std::uint64_t> keys;
    Buffer<Mat3> values;
  };
  FoldView view(bool limited = true) const;
  void fold(const SlotGroup& group, int more, Folded& out) const;
  void set_ahead(Span<const Vec3> q);
  void pass_limits(LinearSolver& linear, int inertia, LinearReport& report);

  std::vector<ArticulationPart> parts_;
  std::vector<int> body_block_;
  int first_block_ = 0, q_blocks_ = 0;
  Buffer<int> solved_;
  Buffer<LinkBlock> links_;
  Buffer<QBlocks> articulations_;
  Buffer<Mat3> jacobian_, inertia_;
  Buffer<Spring> springs_, limitless_;
  Buffer<int> first_spring_;
  Buffer<Vec3> along_, target_;
  HostSprings host_springs_;
  Folded fixed_, contact_;
  BlockMatrix matrix_;
  Buffer<Vec3> points_, right_, solution_, ahead_;
};
}  // namespace tape::TAPE_SIDE
