#include "tape/cutting/adhesion.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <map>
#include <optional>

#include "tape/cutting/transfer.hpp"
#include "tape/effects/triangle_plane.hpp"
#include "tape/math/distance.hpp"

namespace tape {
namespace {
template <class T>
const T& at(const std::vector<T>& values, int i) {
  return values[static_cast<std::size_t>(i)];
}

/// A vertex and a triangle as four points.
struct Four {
  Vec3 x[4];
  Four(const std::vector<Vec3>& all, int vertex, const Index3& triangle)
      : x{at(all, vertex), at(all, triangle[0]), at(all, triangle[1]), at(all, triangle[2])} {}
  Real distance() const { return combine(closest_vertex_triangle(x).weight, x).norm(); }
  /// In which a remembered slip u is B^T u (LaggedSlip): two edges of the triangle, and across them.
  Mat3 basis() const {
    const Vec3 first = x[2] - x[1], second = x[3] - x[1];
    Mat3 B;
    B << first, second, first.cross(second);
    return B;
  }
  Mat3 edges() const {
    Mat3 D;
    D << x[1] - x[0], x[2] - x[0], x[3] - x[0];
    return D;
  }
};
bool has(const Index3& triangle, int vertex) { return (triangle.array() == vertex).any(); }

/// How a pair held: what can be taken over by another pair.
Real engagement(const Cohesion::Memory& m) { return m.beta; }
Real engagement(const Bonds::Memory& m) { return m.cooldown == 0 ? 1 : 0; }

/// Pairs of vertices and triangles, law by law.
template <class Memory>
class PairMover {
 public:
  PairMover(const CutInWorld& cut, const std::vector<Memory>& old) : cut_(cut) {
    for (const Memory& m : old) of_vertex_[m.vertex].push_back(&m);
  }
  std::vector<Memory> moved() {
    for (const auto& [vertex, pairs] : of_vertex_)
      for (const Memory* m : pairs) move_pair(*m);
    for (std::size_t v = 0; v < cut_.cut.parent.size(); ++v)
      if (cut_.cut.parent[v].weight.maxCoeff() < 1) hold_by_new_vertex(static_cast<int>(v));
    std::vector<Memory> out;
    for (const auto& [key, m] : kept_) out.push_back(m);
    return out;
  }

 private:
  Four before(const Memory& m) const { return {cut_.old_x, m.vertex, at(cut_.old_triangles, m.triangle)}; }
  Four after(int vertex, int triangle) const { return {cut_.x, vertex, at(cut_.triangles, triangle)}; }

  void move_pair(const Memory& m) {
    const int vertex = cut_.new_vertex(m.vertex);
    if (vertex < 0) return;
    int triangle = cut_.new_triangle(m.triangle);
    if (triangle >= 0) {
      Memory same = m;
      same.vertex = vertex, same.triangle = triangle;
      keep(same);
      return;
    }
    const Real limit = before(m).distance() * (1 + kRoundOff) + kRoundOff;
    Real nearest = limit;
    for (int t = cut_.first_triangle + cut_.cut.unchanged; t < cut_.first_triangle + std::ssize(cut_.cut.mesh.triangles); ++t) {
      if (has(at(cut_.triangles, t), vertex)) continue;
      const Real d = after(vertex, t).distance();
      if (d < nearest) nearest = d, triangle = t;
    }
    if (triangle >= 0) keep(taken_over({{&m, 1}}, 1, vertex, triangle));
  }

  /// A vertex that the cut has made, counted from the strip's first.
  void hold_by_new_vertex(int v) {
    const Place& parent = at(cut_.cut.parent, v);
    std::map<int, std::vector<std::pair<const Memory*, Real>>> by_triangle;
    Real engaged = 0, reach = 0;
    for (int k = 0; k < 3; ++k) {
      if (parent.weight[k] <= 0) continue;
      const auto it = of_vertex_.find(cut_.first_vertex + at(cut_.old_mesh.triangles, parent.triangle)[k]);
      if (it == of_vertex_.end()) continue;
      Real most = 0;
      for (const Memory* m : it->second) {
        if (!(engagement(*m) > 0)) continue;
        most = std::max(most, engagement(*m));
        reach = std::max(reach, before(*m).distance());
        if (const int t = cut_.new_triangle(m->triangle); t >= 0) by_triangle[t].push_back({m, parent.weight[k]});
      }
      engaged += parent.weight[k] * most;
    }
    const int vertex = cut_.first_vertex + v;
    for (const auto& [triangle, holds] : by_triangle)
      if (!has(at(cut_.triangles, triangle), vertex) && after(vertex, triangle).distance() <= reach * (1 + kRoundOff) + kRoundOff)
        if (const std::optional<Memory> m = held(holds, engaged, vertex, triangle)) keep(*m);
  }

  using Holds = std::vector<std::pair<const Memory*, Real>>;
  std::optional<Memory> held(const Holds& holds, Real engaged, int vertex, int triangle) const {
    if constexpr (std::is_same_v<Memory, Bonds::Memory>)
      if (engaged < 0.5) return {};
    return taken_over(holds, engaged, vertex, triangle);
  }

  /// One pair for several, weighted.
  Memory taken_over(const Holds& holds, Real engaged, int vertex, int triangle) const {
    const auto heaviest = std::ranges::max_element(holds, {}, &std::pair<const Memory*, Real>::second);
    Memory out = *heaviest->first;
    out.vertex = vertex, out.triangle = triangle;
    if constexpr (std::is_same_v<Memory, Cohesion::Memory>) {
      Real beta = 0, sum = 0;
      for (const auto& [m, weight] : holds) beta += weight * m->beta, sum += weight;
      out.beta = std::min(engaged, beta / sum);
      out.slip = after(vertex, triangle).basis().transpose() * before(*heaviest->first).basis().transpose().inverse() * out.slip;
    } else {
      Mat3 strain = Mat3::Zero();
      Real stretch = 0, sum = 0;
      for (const auto& [m, weight] : holds) {
        const Four old = before(*m);
        strain += weight * old.edges() * m->inverse;
        stretch += weight * old.distance() / m->rest;
        sum += weight;
      }
      const Four now = after(vertex, triangle);
      out.inverse = now.edges().inverse() * (strain / sum);
      out.rest = now.distance() / (stretch / sum);
    }
    return out;
  }

  void keep(const Memory& m) {
    if constexpr (std::is_same_v<Memory, Bonds::Memory>)
      if (!m.inverse.allFinite()) return;  // flat
    const auto [it, fresh] = kept_.try_emplace(m.key(), m);
    if (!fresh && engagement(m) > engagement(it->second)) it->second = m;
  }

  static constexpr Real kRoundOff = 1e-9;  // relative, and [m]
  const CutInWorld& cut_;
  std::map<int, std::vector<const Memory*>> of_vertex_;  // of the old world
  std::map<std::uint64_t, Memory> kept_;
};

/// Samples of cohesive zones.
class SampleMover {
 public:
  using Memory = CohesiveZone::Memory;
  SampleMover(const CutInWorld& cut, const std::vector<Memory>& old) : cut_(cut), per_triangle_(cut.samples * cut.samples) {
    for (const Memory& m : old) of_sample_[m.sample].push_back(&m);
    for (std::size_t t = 0; t < cut.cut.new_triangle.size(); ++t)
      if (cut.cut.new_triangle[t] < 0) gone_.push_back(static_cast<int>(t));
  }
  std::vector<Memory> moved() {
    for (const auto& [sample, held] : of_sample_)
      for (const Memory* m : held)
        if (const int t = cut_.new_triangle(sample / per_triangle_); t >= 0) keep(*m, t * per_triangle_ + sample % per_triangle_);
    for (int t = cut_.cut.unchanged; t < std::ssize(cut_.cut.mesh.triangles); ++t)
      for (int k = 0; k < per_triangle_; ++k) hold_by_new_sample(t, k);
    std::ranges::sort(kept_, {}, [](const Memory& m) { return m.key(); });
    return kept_;
  }

 private:
  struct Weights {
    Real w[3];
    Vec3 vector() const { return {w[0], w[1], w[2]}; }
  };
  Weights weights(int k) const {
    Weights out;
    sample_weights(k, cut_.samples, out.w);
    return out;
  }
  /// @param foot  [1] where on the triangle
  TrianglePlane<6> plane(const std::vector<Index3>& triangles, const std::vector<Vec3>& x, int sample, int triangle,
                         const Real (&foot)[3]) const {
    Vec3 corners[6];
    for (int k = 0; k < 3; ++k) {
      corners[k] = at(x, at(triangles, sample / per_triangle_)[k]);
      corners[3 + k] = at(x, at(triangles, triangle)[k]);
    }
    return {corners, weights(sample % per_triangle_).w, foot};
  }

  /// Sample k of triangle t of the strip, which the cut has made.
  void hold_by_new_sample(int t, int k) {
    const Index3& v = at(cut_.cut.mesh.triangles, t);
    const Vec3 w = weights(k).vector();
    const Vec2 point = w[0] * at(cut_.cut.mesh.rest, v[0]) + w[1] * at(cut_.cut.mesh.rest, v[1]) + w[2] * at(cut_.cut.mesh.rest, v[2]);
    const Place old = locate(cut_.old_mesh, gone_, point);
    int nearest = 0;
    for (int other = 1; other < per_triangle_; ++other)
      if ((weights(other).vector() - old.weight).norm() < (weights(nearest).vector() - old.weight).norm()) nearest = other;
    const auto held = of_sample_.find((cut_.first_triangle + old.triangle) * per_triangle_ + nearest);
    if (held == of_sample_.end()) return;
    for (const Memory* m : held->second) keep(*m, (cut_.first_triangle + t) * per_triangle_ + k);
  }

  /// What a sample held, held by a sample of the new world.
  void keep(const Memory& m, int sample) {
    Memory out = m;
    out.sample = sample;
    out.triangle = cut_.new_triangle(m.triangle);
    const bool same = out.triangle >= 0 && cut_.new_triangle(m.sample / per_triangle_) == sample / per_triangle_;
    if (!same && !stand_on(m, out)) return;
    kept_.push_back(out);
  }
  /// Finds the foot of a pair that is not the same any more, as far slipped as it was. @return false: it went with the kerf
  bool stand_on(const Memory& m, Memory& out) const {
    const TrianglePlane<6> before = plane(cut_.old_triangles, cut_.old_x, m.sample, m.triangle, m.foot);
    if (out.triangle < 0) {
      const Place foot = new_place(cut_.old_mesh, cut_.cut, {m.triangle - cut_.first_triangle, {m.foot[0], m.foot[1], m.foot[2]}});
      if (foot.triangle < 0 || cut_.first_triangle + foot.triangle == out.sample / per_triangle_) return false;
      out.triangle = cut_.first_triangle + foot.triangle;
      for (int k = 0; k < 3; ++k) out.foot[k] = foot.weight[k];
    }
    // The foot moves along with the sample.
    const TrianglePlane<6> moved = plane(cut_.triangles, cut_.x, out.sample, out.triangle, out.foot);
    const Vec2 step = moved.metric().inverse() * Vec2(moved.e[0].dot(moved.r - before.r), moved.e[1].dot(moved.r - before.r));
    out.foot[1] += step[0], out.foot[2] += step[1], out.foot[0] -= step.sum();
    const TrianglePlane<6> now = plane(cut_.triangles, cut_.x, out.sample, out.triangle, out.foot);
    const Vec2 slipped = before.metric().inverse() * (before.along() - Vec2(m.met[0], m.met[1]));
    const Vec3 slip = slipped[0] * before.e[0] + slipped[1] * before.e[1];
    for (int a = 0; a < 2; ++a) out.met[a] = now.along()[a] - now.e[a].dot(slip);
    return true;
  }

  const CutInWorld& cut_;
  int per_triangle_;
  std::map<int, std::vector<const Memory*>> of_sample_;  // of the old world
  std::vector<int> gone_;                                // old triangles of the strip
  std::vector<Memory> kept_;
};

/// Index in the world after the cut. Those of the strip are from `first` on, and follow `now`; `left` of them are left.
int renumbered(int i, int first, const std::vector<int>& now, std::ptrdiff_t left) {
  const int local = i - first, n = static_cast<int>(std::ssize(now));
  if (local < 0) return i;
  if (local >= n) return i + static_cast<int>(left) - n;
  return at(now, local) < 0 ? -1 : first + at(now, local);
}
}  // namespace

int CutInWorld::new_vertex(int v) const { return renumbered(v, first_vertex, cut.new_vertex, std::ssize(cut.mesh.rest)); }
int CutInWorld::new_triangle(int t) const { return renumbered(t, first_triangle, cut.new_triangle, std::ssize(cut.mesh.triangles)); }

EffectMemory carried_over(const CutInWorld& cut, const EffectMemory& memory) {
  EffectMemory out = memory;
  for_each_memory(out, [&]<class Memory>(std::vector<Memory>& pairs) {
    const std::vector<Memory> old = pairs;
    if constexpr (std::is_same_v<Memory, CohesiveZone::Memory>)
      pairs = SampleMover(cut, old).moved();
    else
      pairs = PairMover<Memory>(cut, old).moved();
  });
  return out;
}
}  // namespace tape
