#pragma once
#include "tape/bodies/state_view.hpp"

namespace tape {
/// The blocks of unknowns that move a stencil of K vertices, and how: J = dx/dq of each vertex is I for its block of
/// translation, and -skew(arm) for the block of rotation after it, if a body carries it.  Source: [the paper, eq. 6].
template <int K>
struct Relocation {
  int blocks = 0;    ///< distinct ones, <= 2 K; 0 if every vertex is fixed
  int block[2 * K];  ///< ids
  int slot[K];       ///< of each vertex: place of its (first) block in `block`, -1 if fixed
  bool rigid[K];     ///< the vertex has a rotation block too, at slot + 1
  Vec3 arm[K];       ///< [m] from the body's centre of mass, in the world
  bool direct;       ///< vertex i is block i: nothing to relocate
};

template <int K>
TAPE_HD Relocation<K> relocate(const Stencil<K>& stencil, const StateView& s) {
  Relocation<K> r;
  r.direct = true;
  for (int i = 0; i < K; ++i) {
    const VertexOwner o = s.owner[stencil.id[i]];
    r.slot[i] = -1;
    r.rigid[i] = o.block >= 0 && o.body >= 0;
    r.arm[i] = r.rigid[i] ? Vec3(s.x[stencil.id[i]] - s.body[o.body].position) : Vec3(Vec3::Zero());
    r.direct &= o.block >= 0 && o.body < 0;
    if (o.block < 0) continue;
    for (int a = 0; a < r.blocks && r.slot[i] < 0; ++a)
      if (r.block[a] == o.block) r.slot[i] = a;
    if (r.slot[i] >= 0) continue;
    r.slot[i] = r.blocks;
    r.block[r.blocks++] = o.block;
    if (r.rigid[i]) r.block[r.blocks++] = o.block + 1;
  }
  r.direct &= r.blocks == K;
  return r;
}

/// Whether bodies carry all of a stencil, or hold it fixed.
template <int K>
TAPE_HD bool rigid(const Relocation<K>& r) {
  for (int i = 0; i < K; ++i)
    if (r.slot[i] >= 0 && !r.rigid[i]) return false;
  return true;
}

/// Places of the pairs (a, b), a <= b, of m blocks in a list: 0 ... m (m + 1) / 2 - 1.
TAPE_HD inline int pair_slot(int a, int b, int m) { return a * (2 * m - a - 1) / 2 + b; }

/// J^T g [N, N m]: one Vec3 per block, written to out[0 ... blocks).
template <int K>
TAPE_HD void relocate_gradient(const Relocation<K>& r, const VecN<3 * K>& g, Vec3* out) {
  for (int a = 0; a < r.blocks; ++a) out[a] = Vec3::Zero();
  for (int i = 0; i < K; ++i) {
    if (r.slot[i] < 0) continue;
    const Vec3 gi = g.template segment<3>(3 * i);
    out[r.slot[i]] += gi;
    if (r.rigid[i]) out[r.slot[i] + 1] += r.arm[i].cross(gi);
  }
}

/// J^T H J, and with `exact` the second-order term sum_j g_j d2x_j/dq2 of the rotations: the upper blocks, out[pair_slot(a, b)].
/// x(w) = exp(skew w) arm, so that the term of one vertex is (g arm^T + arm g^T)/2 - (g.arm) I at w = 0.
/// Without `exact` it is left out: for contact forces it is large and indefinite, and dropping it keeps the sum positive
/// semidefinite (16 -> 5 Newton iterations a step where it was tried; the bodies' inertia has its own in closed form).
template <int K>
TAPE_HD void relocate_hessian(const Relocation<K>& r, const VecN<3 * K>& g, const MatN<3 * K, 3 * K>& H, bool exact, Mat3* out) {
  const int m = r.blocks;
  if (r.direct) {
    for (int a = 0; a < K; ++a)
      for (int b = a; b < K; ++b) out[pair_slot(a, b, K)] = H.template block<3, 3>(3 * a, 3 * b);
    return;
  }
  for (int p = 0; p < m * (m + 1) / 2; ++p) out[p] = Mat3::Zero();
  for (int i = 0; i < K; ++i) {
    const int a = r.slot[i];
    if (a < 0) continue;
    Mat3 row[2 * K];  // of H J
    for (int b = 0; b < m; ++b) row[b] = Mat3::Zero();
    for (int j = 0; j < K; ++j) {
      if (r.slot[j] < 0) continue;
      const Mat3 h = H.template block<3, 3>(3 * i, 3 * j);
      row[r.slot[j]] += h;
      if (r.rigid[j])
        for (int c = 0; c < 3; ++c) row[r.slot[j] + 1].row(c) += r.arm[j].cross(Vec3(h.row(c).transpose())).transpose();
    }
    for (int b = a; b < m; ++b) out[pair_slot(a, b, m)] += row[b];
    if (!r.rigid[i]) continue;
    for (int b = a + 1; b < m; ++b)
      for (int c = 0; c < 3; ++c) out[pair_slot(a + 1, b, m)].col(c) += r.arm[i].cross(Vec3(row[b].col(c)));
    if (!exact) continue;
    const Vec3 gi = g.template segment<3>(3 * i), y = r.arm[i];
    out[pair_slot(a + 1, a + 1, m)] += 0.5 * (gi * y.transpose() + y * gi.transpose()) - gi.dot(y) * Mat3::Identity();
  }
}

/// A stencil whose every entry is one block of unknowns: nothing to relocate.
template <int K>
struct DirectBlocks {
  static constexpr int blocks = K;
  int block[K];
};
template <int K>
TAPE_HD void relocate_gradient(const DirectBlocks<K>&, const VecN<3 * K>& g, Vec3* out) {
  for (int a = 0; a < K; ++a) out[a] = g.template segment<3>(3 * a);
}
template <int K>
TAPE_HD void relocate_hessian(const DirectBlocks<K>&, const VecN<3 * K>&, const MatN<3 * K, 3 * K>& H, bool, Mat3* out) {
  for (int a = 0; a < K; ++a)
    for (int b = a; b < K; ++b) out[pair_slot(a, b, K)] = H.template block<3, 3>(3 * a, 3 * b);
}
}  // namespace tape
