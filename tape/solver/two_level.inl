#include <cmath>

#include "tape/math/rotation.hpp"
#include "tape/solver/two_level.hpp"

namespace tape::TAPE_SIDE {
namespace two_level {
constexpr Real kDependent = 1e-8;  // share of the trace of the inertia below which an axis moves nothing (points on a line)

/// Axes w_k, the columns, with w_k' J w_l = delta_kl for J = sum |d|^2 I - d d', so that the moves w_k x d are orthonormal:
/// Gram-Schmidt on the coordinate axes, the one that moves the points most first. Axes that J does not tell from zero are zero.
struct Axes {
  Mat3 columns = Mat3::Zero();
  int kept = 0;
};
TAPE_HD inline Axes orthonormal_axes(const Mat3& inertia) {
  Axes axes;
  Mat3 rest = inertia;
  for (; axes.kept < 3; ++axes.kept) {
    int p = 0;
    for (int k = 1; k < 3; ++k)
      if (rest(k, k) > rest(p, p)) p = k;
    if (!(rest(p, p) > kDependent * inertia.trace())) break;
    Vec3 w = Vec3::Unit(p);
    for (int k = 0; k < axes.kept; ++k) w -= axes.columns.col(k) * axes.columns.col(k).dot(inertia.col(p));
    w /= std::sqrt(w.dot(inertia * w));
    axes.columns.col(axes.kept) = w;
    const Vec3 image = inertia * w;
    rest -= image * image.transpose();
  }
  return axes;
}

struct FitModes {
  Span<const RigidGroup> groups;
  Span<const Vec3> points;
  Span<RigidModes> modes;
  Span<Mat3> left_out;  // [groups] ones on the diagonal for the rotations without a mode
  TAPE_HD void operator()(int g) const {
    const RigidGroup group = groups[g];
    left_out[g] = Mat3::Zero();
    if (group.body) {
      modes[group.first] = {1, Mat3::Zero()};
      modes[group.first + 1] = {0, Mat3::Identity()};
    } else {
      fit_points(g, group.first, group.first + group.blocks);
    }
  }
  TAPE_HD void fit_points(int g, int begin, int end) const {
    Vec3 centre = Vec3::Zero();
    for (int i = begin; i < end; ++i) centre += points[i];
    centre /= end - begin;
    Mat3 inertia = Mat3::Zero();
    for (int i = begin; i < end; ++i) {
      const Vec3 d = points[i] - centre;
      inertia += d.squaredNorm() * Mat3::Identity() - d * d.transpose();
    }
    const Axes axes = orthonormal_axes(inertia);
    for (int k = axes.kept; k < 3; ++k) left_out[g](k, k) = 1;
    const Real translation = 1 / std::sqrt(static_cast<Real>(end - begin));
    for (int i = begin; i < end; ++i) modes[i] = {translation, -skew(points[i] - centre) * axes.columns};
  }
};

/// A row of A as runs: entries one after the other whose columns lie in one group, that of the row or a later one. Both group and
/// column ascend along a row, so each coarse block of the upper triangle meets a row in one run.
struct Runs {
  RowsView a;
  Span<const int> group;
  TAPE_HD int next(int i, int e) const {
    while (e < a.begin[i + 1] && group[a.entries[e].col] < group[i]) ++e;
    return group[i] < 0 ? a.begin[i + 1] : e;
  }
  TAPE_HD int first(int i) const { return next(i, a.begin[i]); }
  TAPE_HD int end(int i, int e) const {
    const int g = group[a.entries[e].col];
    while (e < a.begin[i + 1] && group[a.entries[e].col] == g) ++e;
    return e;
  }
};
struct CountRuns {
  Runs runs;
  Span<int> count;
  TAPE_HD void operator()(int i) const {
    count[i] = 0;
    for (int e = runs.first(i); e < runs.a.begin[i + 1]; e = runs.next(i, runs.end(i, e))) ++count[i];
  }
};
struct ListKeys {
  Runs runs;
  Span<const int> run_begin;
  int first_slot;
  Span<std::uint64_t> keys;
  TAPE_HD void operator()(int i) const {
    int slot = first_slot + 4 * run_begin[i];
    for (int e = runs.first(i); e < runs.a.begin[i + 1]; e = runs.next(i, runs.end(i, e))) {
      const int g = runs.group[i], h = runs.group[runs.a.entries[e].col];
      keys[slot++] = block_key(2 * g, 2 * h);
      keys[slot++] = block_key(2 * g, 2 * h + 1);
      keys[slot++] = g == h ? kNoBlock : block_key(2 * g + 1, 2 * h);
      keys[slot++] = block_key(2 * g + 1, 2 * h + 1);
    }
  }
};
struct DiagonalKeys {
  Span<std::uint64_t> keys;
  TAPE_HD void operator()(int g) const { keys[g] = block_key(2 * g + 1, 2 * g + 1); }
};
struct SumRuns {  // P_i' (A P)_ih
  Runs runs;
  Span<const int> run_begin;
  Span<const RigidModes> modes;
  int first_slot;
  Span<Mat3> values;
  TAPE_HD void operator()(int i) const {
    int slot = first_slot + 4 * run_begin[i];
    for (int e = runs.first(i); e < runs.a.begin[i + 1]; e = runs.next(i, e)) {
      Mat3 by_translation = Mat3::Zero(), by_rotation = Mat3::Zero();
      for (const int end = runs.end(i, e); e < end; ++e) {
        const Mat3 block = runs.a.entry(e);
        const RigidModes& m = modes[runs.a.entries[e].col];
        by_translation += m.translation * block;
        by_rotation += block * m.rotation;
      }
      const RigidModes& m = modes[i];
      values[slot++] = m.translation * by_translation;
      values[slot++] = m.translation * by_rotation;
      values[slot++] = m.rotation.transpose() * by_translation;
      values[slot++] = m.rotation.transpose() * by_rotation;
    }
  }
};

struct Restrict {  // P' r
  Span<const RigidGroup> groups;
  Span<const RigidModes> modes;
  Span<const Vec3> r;
  Span<Vec3> coarse;
  TAPE_HD void operator()(int g) const {
    Vec3 t = Vec3::Zero(), w = Vec3::Zero();
    for (int i = groups[g].first; i < groups[g].first + groups[g].blocks; ++i) {
      t += modes[i].translation * r[i];
      w += modes[i].rotation.transpose() * r[i];
    }
    coarse[2 * g] = t;
    coarse[2 * g + 1] = w;
  }
};
struct AddProlonged {  // z += P y
  Span<const int> group;
  Span<const RigidModes> modes;
  Span<const Vec3> coarse;
  Span<Vec3> z;
  TAPE_HD void operator()(int i) const {
    const int g = group[i];
    if (g >= 0) z[i] += modes[i].translation * coarse[2 * g] + modes[i].rotation * coarse[2 * g + 1];
  }
};
}  // namespace two_level

TwoLevel::TwoLevel(const SystemLayout& layout) : jacobi_(layout), layout_(rigid_groups(layout)) {
  groups_.upload(layout_);
  for (Buffer<Vec3>* v : {&coarse_r_, &coarse_z_}) v->resize(2 * groups_.size());
}

bool TwoLevel::build(const BlockMatrix& a, Span<const Vec3> points) {
  TAPE_CHECK(points.size == a.size());
  if (!jacobi_.build(a, points)) return false;
  if (layout_.empty()) return true;
  if (pattern_ != a.pattern()) set_pattern(a);
  parallel_for(groups_.size(), two_level::FitModes{groups_.span(), points, modes_.span(), fixed_.values.span()});
  sum_runs(a.view().fixed, groups_.size(), fixed_);
  sum_runs(a.view().contact, 0, contact_);
  coarse_.accumulate_fixed(fixed_.values.span());
  coarse_.accumulate_contact(contact_.values.span());
  coarse_.download(coarse_host_);
  return cholesky_.factor(coarse_host_);
}

void TwoLevel::set_pattern(const BlockMatrix& a) {
  group_of_.upload(group_of_blocks(layout_, a.size()));
  modes_.resize(a.size());
  list_runs(a.view().fixed, groups_.size(), fixed_);
  parallel_for(groups_.size(), two_level::DiagonalKeys{fixed_.keys.span()});
  list_runs(a.view().contact, 0, contact_);
  coarse_.set_fixed_pattern(2 * groups_.size(), fixed_.keys.span());
  coarse_.set_contact_pattern(contact_.keys.span());
  pattern_ = a.pattern();
}

void TwoLevel::list_runs(RowsView rows, int first_slot, Slots& slots) const {
  const two_level::Runs runs{rows, group_of_.span()};
  const int n = group_of_.size();
  slots.run_begin.resize(n);
  parallel_for(n, two_level::CountRuns{runs, slots.run_begin.span()});
  slots.keys.resize(first_slot + 4 * exclusive_scan(slots.run_begin.span()));
  slots.values.resize(slots.keys.size());
  parallel_for(n, two_level::ListKeys{runs, slots.run_begin.span(), first_slot, slots.keys.span()});
}

void TwoLevel::sum_runs(RowsView rows, int first_slot, Slots& slots) const {
  const two_level::Runs runs{rows, group_of_.span()};
  parallel_for(group_of_.size(), two_level::SumRuns{runs, slots.run_begin.span(), modes_.span(), first_slot, slots.values.span()});
}

void TwoLevel::apply(Span<const Vec3> r, Span<Vec3> z) {
  jacobi_.apply(r, z);
  if (layout_.empty()) return;
  parallel_for(groups_.size(), two_level::Restrict{groups_.span(), modes_.span(), r, coarse_r_.span()});
  const std::vector<Vec3> rhs = coarse_r_.download();
  std::vector<Vec3> solution(rhs.size());
  cholesky_.solve({rhs.data(), coarse_r_.size()}, {solution.data(), coarse_r_.size()});
  coarse_z_.upload(solution);
  parallel_for(z.size, two_level::AddProlonged{group_of_.span(), modes_.span(), coarse_z_.span(), z});
}
}  // namespace tape::TAPE_SIDE
