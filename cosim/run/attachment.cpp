#include "cosim/run/attachment.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <numeric>
#include <utility>

#include "tape/step/engagement.hpp"

namespace cosim {
namespace {
using tape::Index3;
using tape::Real;

constexpr Real kAdheres = 0.5;  // [1] engagement

/// Which vertices [strip vertices of the world] of an object adhere to another one, or to any.
std::vector<char> adhering(const tape::World& world, const tape::State& state, std::size_t object, std::optional<std::size_t> other) {
  std::vector<char> adheres(state.x.size(), 0);
  const auto is = [&](int v, std::size_t wanted) {
    return world.surface.vertices[static_cast<std::size_t>(v)].object == static_cast<int>(wanted);
  };
  const auto mark = [&](const std::vector<int>& vertices, int on) {
    if (!is(vertices[0], object) || (other && !is(on, *other))) return;
    for (int v : vertices) adheres[static_cast<std::size_t>(v)] = 1;
  };
  const auto mark_pairs = [&](tape::EffectMemory memory) {
    for_each_memory(memory, [&](const auto& pairs) {
      for (const auto& pair : pairs) {
        if (!(pair.engagement(adhesion_of(world, pair)) > kAdheres)) continue;
        const tape::SurfaceTriangle& triangle = world.surface.triangles[static_cast<std::size_t>(pair.triangle)];
        const std::vector<int> own = sticking_vertices(world, pair), face(std::begin(triangle.v), std::end(triangle.v));
        mark(own, face[0]);
        mark(face, own[0]);
      }
    });
  };
  mark_pairs(state.memory);
  if (state.sleepers) mark_pairs(state.sleepers->asleep);
  return adheres;
}

/// Calls f with the vertices of each triangle of a strip.
template <class F>
void for_each_triangle(const tape::World& world, std::size_t strip, const F& f) {
  const tape::StripPart& part = world.assembly.strips[strip];
  for (int t = part.first_triangle; t < part.first_triangle + part.triangles; ++t) f(world.assembly.triangles[static_cast<std::size_t>(t)]);
}

using Spans = std::vector<std::pair<Real, Real>>;  // [m] in order, apart
Spans merged(Spans spans) {
  std::ranges::sort(spans);
  Spans out;
  for (const auto& span : spans) {
    if (out.empty() || span.first > out.back().second)
      out.push_back(span);
    else
      out.back().second = std::max(out.back().second, span.second);
  }
  return out;
}
Real length_in_both(const Spans& a, const Spans& b) {
  Real sum = 0;
  for (const auto& [from, to] : a)
    for (const auto& [start, end] : b) sum += std::max<Real>(0, std::min(to, end) - std::max(from, start));
  return sum;
}
}  // namespace

double attached_share(const tape::World& world, const tape::State& state, std::size_t strip, std::optional<std::size_t> other) {
  const std::vector<char> adheres = adhering(world, state, strip, other);
  const tape::StripPart& part = world.assembly.strips[strip];
  Real attached = 0, all = 0;
  for (int v = part.first_vertex; v < part.first_vertex + part.vertices; ++v) {
    const Real area = world.surface.vertices[static_cast<std::size_t>(v)].area;
    all += area;
    if (adheres[static_cast<std::size_t>(v)]) attached += area;
  }
  return attached / all;
}

double covered_seam(const tape::World& world, const tape::State& state, std::size_t strip, std::size_t first, std::size_t second,
                    const tape::Vec3& along) {
  const auto covered = [&](std::size_t side) {
    const std::vector<char> adheres = adhering(world, state, strip, side);
    Spans spans;
    for_each_triangle(world, strip, [&](const Index3& triangle) {
      for (int k = 0; k < 3; ++k) {
        const auto a = static_cast<std::size_t>(triangle[k]), b = static_cast<std::size_t>(triangle[(k + 1) % 3]);
        if (adheres[a] && adheres[b]) spans.push_back(std::minmax({along.dot(state.x[a]), along.dot(state.x[b])}));
      }
    });
    return merged(std::move(spans));
  };
  return length_in_both(covered(first), covered(second));
}

double attached_turns(const tape::World& world, const tape::State& state, std::size_t strip, double wound, const tape::Vec3& point,
                      const tape::Vec3& axis) {
  const std::vector<char> adheres = adhering(world, state, strip, std::nullopt);
  const tape::Vec3 u = axis.unitOrthogonal(), w = axis.cross(u);
  const auto angle = [&](int v) {
    const tape::Vec3 r = state.x[static_cast<std::size_t>(v)] - point;
    return std::atan2(w.dot(r), u.dot(r));
  };
  Real sum = 0, low = 0, high = 0;
  for_each_triangle(world, strip, [&](const Index3& t) {
    bool counts = true;
    std::array<tape::Vec2, 3> X;
    for (int k = 0; k < 3; ++k) {
      const auto v = static_cast<std::size_t>(t[k]);
      X[k] = world.assembly.rest[v];
      low = std::min(low, X[k].y()), high = std::max(high, X[k].y());
      counts = counts && adheres[v] && X[k].x() >= wound;
    }
    if (!counts) return;
    // Slope of the angle along the strip, which is constant on a triangle, times its area.
    const Real first = std::remainder(angle(t[1]) - angle(t[0]), 2 * std::numbers::pi);
    const Real second = std::remainder(angle(t[2]) - angle(t[0]), 2 * std::numbers::pi);
    sum += (first * (X[2] - X[0]).y() - second * (X[1] - X[0]).y()) / 2;
  });
  return std::fabs(sum) / (high - low) / (2 * std::numbers::pi);
}

int pieces(const tape::World& world, std::size_t strip) {
  const tape::StripPart& part = world.assembly.strips[strip];
  std::vector<int> parent(static_cast<std::size_t>(part.vertices));
  std::iota(parent.begin(), parent.end(), 0);
  const auto root = [&](int v) {
    v -= part.first_vertex;
    while (parent[static_cast<std::size_t>(v)] != v) v = parent[static_cast<std::size_t>(v)];
    return v;
  };
  for_each_triangle(world, strip, [&](const Index3& triangle) {
    for (int k = 1; k < 3; ++k) {
      const auto [low, high] = std::minmax({root(triangle[0]), root(triangle[k])});
      parent[static_cast<std::size_t>(high)] = low;
    }
  });
  int count = 0;
  for (int v = 0; v < part.vertices; ++v) count += parent[static_cast<std::size_t>(v)] == v;
  return count;
}
}  // namespace cosim
