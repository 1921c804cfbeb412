#include <limits>

#include "tape/core/functors.hpp"
#include "tape/solver/articulations.hpp"

namespace tape::TAPE_SIDE {
namespace articulations {
/// How many blocks of the solved system a block of the unknowns' matrix contributes to.
struct CountFolded {
  FoldView f;
  Span<const std::uint64_t> keys;
  Span<int> count;  // [blocks + 1], the last stays 0
  TAPE_HD void operator()(int k) const {
    count[k] = 0;
    if (k == keys.size) return;
    const LinkBlock *const a = f.link(static_cast<int>(keys[k] >> 32)), *const b = f.link(static_cast<int>(keys[k] & 0xffffffffu));
    const int rows = a ? f.of(*a).count : 1, columns = b ? f.of(*b).count : 1;
    count[k] = a && b && a->articulation == b->articulation ? rows * (rows + 1) / 2 : rows * columns;
  }
};
/// Writes them. H_ij between links of one articulation stands for H_ji too, so that its share is symmetric.
struct Fold {
  FoldView f;
  Span<const std::uint64_t> keys;
  Span<const Mat3> values;
  Span<const int> offset;
  Span<std::uint64_t> keys_out;
  Span<Mat3> values_out;
  TAPE_HD void operator()(int k) const {
    const int i = static_cast<int>(keys[k] >> 32), j = static_cast<int>(keys[k] & 0xffffffffu);
    const LinkBlock *const a = f.link(i), *const b = f.link(j);
    const int row = a ? f.of(*a).solved : f.solved[i], rows = a ? f.of(*a).count : 1;
    const int column = b ? f.of(*b).solved : f.solved[j], columns = b ? f.of(*b).count : 1;
    const bool same = a && b && a->articulation == b->articulation;
    int slot = offset[k];
    for (int r = 0; r < rows; ++r) {
      for (int c = same ? r : 0; c < columns; ++c, ++slot) {
        Mat3 m = share(a, r, values[k], b, c);
        if (same && i != j) m += share(a, c, values[k], b, r).transpose();
        const bool upper = row + r <= column + c;
        keys_out[slot] = upper ? block_key(row + r, column + c) : block_key(column + c, row + r);
        values_out[slot] = upper ? m : Mat3(m.transpose());
      }
    }
  }

 private:
  TAPE_HD Mat3 share(const LinkBlock* a, int r, const Mat3& H, const LinkBlock* b, int c) const {
    const Mat3 right = b ? Mat3(H * f.jacobian[b->jacobian + c]) : H;
    return a ? Mat3(f.jacobian[a->jacobian + r].transpose() * right) : right;
  }
};
/// How far an articulation's coordinates are ahead along a spring.
TAPE_HD inline Real ahead_along(const FoldView& f, const Spring& spring, Span<const Vec3> ahead) {
  const QBlocks& of = f.articulations[spring.articulation];
  Real sum = 0;
  for (int c = 0; c < of.count; ++c) sum += f.along[spring.along + c].dot(ahead[of.first + c]);
  return sum;
}
/// The inertia and the springs' stiffness, in the slots from `slot` on.
struct AddInertia {
  FoldView f;
  int slot;
  Span<const Vec3> ahead;  // of the target
  Span<std::uint64_t> keys;
  Span<Mat3> values;
  TAPE_HD void operator()(int articulation) const {
    int at = slot;
    for (int k = 0; k < articulation; ++k) at += f.articulations[k].count * (f.articulations[k].count + 1) / 2;
    const QBlocks& of = f.articulations[articulation];
    for (int r = 0; r < of.count; ++r) {
      for (int c = r; c < of.count; ++c, ++at) {
        keys[at] = block_key(of.solved + r, of.solved + c);
        values[at] = f.inertia[of.inertia + r * of.count + c];
        for (int k = f.first_spring[articulation]; k < f.first_spring[articulation + 1]; ++k) {
          const Spring& spring = f.springs[k];
          values[at] += spring.slope(ahead_along(f, spring, ahead)) * f.along[spring.along + r] * f.along[spring.along + c].transpose();
        }
      }
    }
  }
};
/// inertia (q - target) / dt^2 of one block of an articulation.
TAPE_HD inline Vec3 inertia_pull(const FoldView& f, const QBlocks& part, Span<const Vec3> ahead, int row) {
  Vec3 sum = Vec3::Zero();
  for (int c = 0; c < part.count; ++c) sum += f.inertia[part.inertia + row * part.count + c] * ahead[part.first + c];
  return sum;
}
struct Energy {
  FoldView f;
  Span<const Vec3> ahead;
  TAPE_HD EnergySum operator()(int articulation) const {
    const QBlocks& part = f.articulations[articulation];
    Real sum = 0;
    for (int r = 0; r < part.count; ++r) sum += ahead[part.first + r].dot(inertia_pull(f, part, ahead, r)) / 2;
    for (int k = f.first_spring[articulation]; k < f.first_spring[articulation + 1]; ++k)
      sum += f.springs[k].energy(ahead_along(f, f.springs[k], ahead));
    return {sum, sum};
  }
};
/// What is no link goes over as it is.
struct Gather {
  Span<const int> solved;
  Span<const Vec3> from;
  Span<Vec3> to;
  TAPE_HD void operator()(int i) const {
    if (solved[i] >= 0) to[solved[i]] = from[i];
  }
};
struct FoldRight {
  FoldView f;
  int first_block;
  Span<const Vec3> ahead;
  Span<Vec3> b;
  TAPE_HD void operator()(int articulation) const {
    const QBlocks& part = f.articulations[articulation];
    for (int r = 0; r < part.count; ++r) {
      Vec3 sum = -inertia_pull(f, part, ahead, r);
      for (int k = f.first_spring[articulation]; k < f.first_spring[articulation + 1]; ++k)
        sum -= f.springs[k].force(ahead_along(f, f.springs[k], ahead)) * f.along[f.springs[k].along + r];
      for (int l = part.first_link; l < part.first_link + part.link_blocks; ++l)
        sum += f.jacobian[f.links[l].jacobian + r].transpose() * b[f.links[l].block];
      b[first_block + part.first + r] = sum;
    }
    for (int l = part.first_link; l < part.first_link + part.link_blocks; ++l) b[f.links[l].block].setZero();
  }
};
struct Unfold {
  FoldView f;
  Span<const Vec3> solution;
  Span<Vec3> x;
  TAPE_HD void operator()(int i) const {
    const LinkBlock* const link = f.link(i);
    if (!link) {
      x[i] = solution[f.solved[i]];
      return;
    }
    const QBlocks& part = f.of(*link);
    x[i].setZero();
    for (int c = 0; c < part.count; ++c) x[i] += f.jacobian[link->jacobian + c] * solution[part.solved + c];
  }
};
struct Ahead {
  Span<const Vec3> q, target;
  Span<Vec3> ahead;
  TAPE_HD void operator()(int k) const { ahead[k] = q[k] - target[k]; }
};
/// Coordinates one after the other.
inline Eigen::VectorXd in_line(const std::vector<Vec3>& v) {
  return v.empty() ? Eigen::VectorXd() : Eigen::Map<const Eigen::VectorXd>(v.front().data(), 3 * static_cast<Eigen::Index>(v.size()));
}
inline std::vector<Vec3> in_blocks(const Eigen::VectorXd& v) {
  std::vector<Vec3> out;
  for (Eigen::Index k = 0; k < v.size(); k += 3) out.emplace_back(v.segment<3>(k));
  return out;
}
/// Piece (row, column) of a matrix that beyond its end is like `out`.
inline Mat3 piece(const Eigen::MatrixXd& m, int row, int column, Mat3 out = Mat3::Zero()) {
  for (int r = 0; r < 3 && 3 * row + r < m.rows(); ++r)
    for (int c = 0; c < 3 && 3 * column + c < m.cols(); ++c) out(r, c) = m(3 * row + r, 3 * column + c);
  return out;
}
}  // namespace articulations

inline Articulations::Articulations(const Assembly& assembly) : parts_(assembly.articulations) {
  for (const BodyPart& body : assembly.bodies) body_block_.push_back(body.block);
  if (any()) first_block_ = parts_.front().first_block;
  for (const ArticulationPart& part : parts_) q_blocks_ += part.blocks;
}

inline SystemLayout Articulations::set_layout(const SystemLayout& unknowns, int blocks) {
  std::vector<LinkBlock> links;
  std::vector<int> solved(static_cast<std::size_t>(blocks), 0);
  std::vector<QBlocks> all;
  int pieces = 0, inertia = 0;
  for (std::size_t a = 0; a < parts_.size(); ++a) {
    const ArticulationPart& part = parts_[a];
    all.push_back({part.first_block - first_block_, part.blocks, 0, inertia, static_cast<int>(links.size()), 0});
    inertia += part.blocks * part.blocks;
    for (int body : part.links) {
      for (int block = body_block_[static_cast<std::size_t>(body)], k = 0; k < 2; ++k, pieces += part.blocks) {
        solved[static_cast<std::size_t>(block + k)] = -1 - static_cast<int>(links.size());
        links.push_back({block + k, static_cast<int>(a), pieces});
      }
    }
    all.back().link_blocks = static_cast<int>(links.size()) - all.back().first_link;
  }
  int n = 0;
  for (int& s : solved)
    if (s >= 0) s = n++;
  for (QBlocks& q : all) q.solved = solved[static_cast<std::size_t>(first_block_ + q.first)];
  links_.upload(links), articulations_.upload(all), solved_.upload(solved);
  for (Buffer<Vec3>* v : {&points_, &right_, &solution_}) v->resize(n);
  SystemLayout layout;
  for (StripLayout strip : unknowns.strips) {
    if (strip.blocks > 0) strip.first_block = solved[static_cast<std::size_t>(strip.first_block)];
    layout.strips.push_back(strip);
  }
  for (int block : unknowns.body_blocks)
    if (solved[static_cast<std::size_t>(block)] >= 0) layout.body_blocks.push_back(solved[static_cast<std::size_t>(block)]);
  return layout;
}

inline void Articulations::begin(const std::vector<ArticulationStep>& steps, const std::vector<Eigen::VectorXd>& target, Real dt) {
  TAPE_CHECK(steps.size() == parts_.size() && target.size() == parts_.size());
  std::vector<Mat3> jacobian, inertia;
  std::vector<Vec3> to;
  std::vector<Spring> springs;
  std::vector<int> first_spring = {0};
  std::vector<Vec3> along;
  for (std::size_t a = 0; a < parts_.size(); ++a) {
    const ArticulationPart& part = parts_[a];
    TAPE_CHECK(steps[a].inertia.rows() == part.coordinates && steps[a].inertia.cols() == part.coordinates);
    TAPE_CHECK(target[a].size() == part.coordinates && steps[a].jacobian.size() == part.links.size());
    const Eigen::MatrixXd over_dt2 = steps[a].inertia / (dt * dt);
    for (const Eigen::MatrixXd& J : steps[a].jacobian) {
      TAPE_CHECK(J.rows() == 6 && J.cols() == part.coordinates);
      for (int half = 0; half < 2; ++half)
        for (int c = 0; c < part.blocks; ++c) jacobian.push_back(articulations::piece(J, half, c));
    }
    for (int r = 0; r < part.blocks; ++r) {
      for (int c = 0; c < part.blocks; ++c)
        inertia.push_back(articulations::piece(over_dt2, r, c, r == c ? Mat3(Mat3::Identity()) : Mat3(Mat3::Zero())));
      to.push_back(articulations::piece(target[a], r, 0).col(0));
    }
    for (const LimitedSpring& spring : steps[a].springs) {
      TAPE_CHECK(spring.along.size() == part.coordinates);
      springs.push_back({spring.stiffness / (dt * dt), spring.least, spring.most, static_cast<int>(a), static_cast<int>(along.size())});
      for (int r = 0; r < part.blocks; ++r) along.emplace_back(articulations::piece(spring.along, r, 0).col(0));
    }
    first_spring.push_back(static_cast<int>(springs.size()));
  }
  jacobian_.upload(jacobian), inertia_.upload(inertia), target_.upload(to);
  springs_.upload(springs), first_spring_.upload(first_spring), along_.upload(along);
  host_springs_ = {springs, Eigen::MatrixXd::Zero(3 * q_blocks_, static_cast<Eigen::Index>(springs.size()))};
  for (std::size_t k = 0; k < springs.size(); ++k) {
    const ArticulationPart& part = parts_[static_cast<std::size_t>(springs[k].articulation)];
    for (int r = 0; r < part.blocks; ++r)
      host_springs_.along.block<3, 1>(3 * (part.first_block - first_block_ + r), static_cast<Eigen::Index>(k)) =
          along[static_cast<std::size_t>(springs[k].along + r)];
  }
  constexpr Real kNone = std::numeric_limits<Real>::infinity();
  for (Spring& spring : springs) spring.least = -kNone, spring.most = kNone;
  limitless_.upload(springs);
}

inline FoldView Articulations::view(bool limited) const {
  return {solved_.span(),       links_.span(),   articulations_.span(),
          jacobian_.span(),     inertia_.span(), (limited ? springs_ : limitless_).span(),
          first_spring_.span(), along_.span()};
}

inline void Articulations::set_ahead(Span<const Vec3> q) {
  ahead_.resize(q_blocks_);
  parallel_for(q_blocks_, articulations::Ahead{q, target_.span(), ahead_.span()});
}

inline EnergySum Articulations::energy(Span<const Vec3> q) {
  set_ahead(q);
  return reduce(articulations_.size(), EnergySum{}, articulations::Energy{view(), ahead_.span()}, Plus{});
}

/// The slots of a group in the solved system, and room for `more` after them.
inline void Articulations::fold(const SlotGroup& group, int more, Folded& out) const {
  const Span<const std::uint64_t> keys = group.keys().span();
  out.offset.resize(keys.size + 1);
  parallel_for(keys.size + 1, articulations::CountFolded{view(), keys, out.offset.span()});
  const int slots = exclusive_scan(out.offset.span());
  out.keys.resize(slots + more), out.values.resize(slots + more);
  parallel_for(keys.size, articulations::Fold{view(), keys, group.values().span(), out.offset.span(), out.keys.span(), out.values.span()});
}

inline LinearReport Articulations::solve(LinearSolver& linear, const BlockMatrix& a, Span<const Vec3> points, Span<const Vec3> q,
                                         bool limited, Span<Vec3> b, Span<Vec3> x) {
  int more = 0;
  for (const ArticulationPart& part : parts_) more += part.blocks * (part.blocks + 1) / 2;
  fold(a.fixed(), more, fixed_);
  const int inertia = fixed_.keys.size() - more;
  set_ahead(q);
  parallel_for(articulations_.size(),
               articulations::AddInertia{view(limited), inertia, ahead_.span(), fixed_.keys.span(), fixed_.values.span()});
  fold(a.contact(), 0, contact_);
  matrix_.set_fixed_pattern(right_.size(), fixed_.keys.span());
  matrix_.accumulate_fixed(fixed_.values.span());
  matrix_.set_contact_pattern(contact_.keys.span());
  matrix_.accumulate_contact(contact_.values.span());
  parallel_for(articulations_.size(), articulations::FoldRight{view(limited), first_block_, ahead_.span(), b});
  parallel_for(b.size, articulations::Gather{solved_.span(), b, right_.span()});
  parallel_for(b.size, articulations::Gather{solved_.span(), points, points_.span()});
  LinearReport report = linear.solve(matrix_, points_.span(), right_.span(), solution_.span());
  if (limited && !report.negative_curvature) pass_limits(linear, inertia, report);
  parallel_for(b.size, articulations::Unfold{view(), solution_.span(), x});
  return report;
}

/// solution_ is the minimum of Newton's parabola, in which each spring goes on as it does where the unknowns are. Takes it to the minimum
/// of what is a parabola between the springs' limits: Newton's method again, with an exact line search. The gradient without springs, rest
/// = H x - b, needs no product with H: of an update d that solves (H + S) d = -(rest + f), H d = -f - S d - rest. Each update lowers the
/// model, so that what kMost of them reach is a direction too.
inline void Articulations::pass_limits(LinearSolver& linear, int inertia, LinearReport& report) {
  constexpr int kMost = 20;
  using Vector = Eigen::VectorXd;
  const HostSprings& springs = host_springs_;
  const Eigen::Index first = 3 * articulations_.download().front().solved, count = 3 * q_blocks_;
  Vector end = articulations::in_line(solution_.download()), x = Vector::Zero(end.size()),
         ahead = articulations::in_line(ahead_.download());
  Vector right = articulations::in_line(right_.download());
  right.segment(first, count) += springs.force(ahead);
  Vector rest = -right;
  for (int k = 0; k < kMost; ++k) {
    const Vector d = end - x, turn = d.segment(first, count), force = springs.force(ahead);
    if (springs.side(ahead + turn) == springs.side(ahead)) return;
    Vector bend = -rest;
    bend.segment(first, count) -= force + springs.stiffness(ahead, turn);
    const auto rise = [&, at = d.dot(rest), by = d.dot(bend)](Real t) { return at + t * by + turn.dot(springs.force(ahead + t * turn)); };
    if (!(rise(0) < 0)) break;  // as near to the minimum as the linear solver sees
    Real t = 1;
    if (rise(1) > 0)
      for (Real low = 0, high = 1; high - low > 1e-12; (rise(t) > 0 ? high : low) = t) t = (low + high) / 2;
    x += t * d, rest += t * bend, ahead += t * turn;
    Vector b = right;
    b.segment(first, count) += springs.stiffness(ahead, x.segment(first, count)) - springs.force(ahead);
    right_.upload(articulations::in_blocks(b)), ahead_.upload(articulations::in_blocks(ahead));
    parallel_for(articulations_.size(),
                 articulations::AddInertia{view(), inertia, ahead_.span(), fixed_.keys.span(), fixed_.values.span()});
    matrix_.accumulate_fixed(fixed_.values.span());
    const LinearReport again = linear.solve(matrix_, points_.span(), right_.span(), solution_.span());
    report.iterations += again.iterations;
    report.converged = report.converged && again.converged;
    report.negative_curvature = again.negative_curvature;
    if (again.negative_curvature) return;
    end = articulations::in_line(solution_.download());
  }
  solution_.upload(articulations::in_blocks(x));
}

inline std::vector<Eigen::VectorXd> Articulations::coordinates(const std::vector<Vec3>& q) const {
  std::vector<Eigen::VectorXd> out;
  for (const ArticulationPart& part : parts_) {
    Eigen::VectorXd& of = out.emplace_back(part.coordinates);
    for (int k = 0; k < part.coordinates; ++k) of[k] = q[static_cast<std::size_t>(part.first_block - first_block_ + k / 3)][k % 3];
  }
  return out;
}
}  // namespace tape::TAPE_SIDE
