#include "tape/reduction/front.hpp"

#include <algorithm>
#include <cmath>
#include <set>

#include "tape/math/rotation.hpp"

namespace tape {
namespace {
/// Calls f(v) for the vertices of the strip, counted from its first, that a bond of the wound roll holds: its sides are the vertex and the
/// triangle, and where a side is another thing, or free tape that lies on the roll again, it is none.
template <class F>
void for_each_held(const FrontView& view, const Cluster& cluster, const Bonds::Memory& bond, const F& f) {
  const auto in_strip = [&](int v) { return v >= view.strip.first_vertex && v < view.strip.first_vertex + view.strip.vertices; };
  const auto free = [&](int v) { return in_strip(v) && (*cluster.distance)[static_cast<std::size_t>(v - view.strip.first_vertex)] == 0; };
  const auto in_core = [&](int v) { return v >= view.core.first_vertex && v < view.core.first_vertex + view.core.vertices; };
  const Index3& triangle = view.assembly.triangles[static_cast<std::size_t>(bond.triangle)];
  const auto of_roll = [&](int v) { return in_strip(v) || in_core(v); };
  if (!of_roll(bond.vertex) || !std::ranges::all_of(triangle, of_roll)) return;
  const bool free_triangle = std::ranges::any_of(triangle, free);
  if (!free_triangle && in_strip(bond.vertex)) f(bond.vertex - view.strip.first_vertex);
  if (free(bond.vertex)) return;
  for (int v : triangle)
    if (in_strip(v)) f(v - view.strip.first_vertex);
}
Real off_axis(const Pose& hub, const Vec3& x) { return (hub.rotation.transpose() * (x - hub.position)).head<2>().norm(); }
}  // namespace

void mark_released(const FrontView& view, const std::vector<Bonds::Memory>& before, const std::vector<Bonds::Memory>& after,
                   Cluster& cluster) {
  std::set<std::uint64_t> holding;
  for (const Bonds::Memory& bond : after)
    if (bond.replaces_contact()) holding.insert(bond.key());
  for (const Bonds::Memory& bond : before)
    if (bond.replaces_contact() && !holding.contains(bond.key()))
      for_each_held(view, cluster, bond, [&](int v) { cluster.released.insert(v); });
}

std::vector<int> pass_front(const FrontView& view, const Cluster& cluster, const std::vector<int>& next, Gate gate, Real delta,
                            const std::vector<Bonds::Memory>* bonds) {
  std::set<int> held;
  if (bonds)
    for (const Bonds::Memory& bond : *bonds)
      if (bond.replaces_contact()) for_each_held(view, cluster, bond, [&](int v) { held.insert(v); });
  std::vector<int> pass;
  for (int v : next) {
    if (bonds && (!cluster.released.contains(v) || held.contains(v))) continue;
    const Vec3& x = view.x[static_cast<std::size_t>(view.strip.first_vertex + v)];
    const Vec3 carried = apply(view.cluster, (*cluster.local)[static_cast<std::size_t>(v)] - cluster.centre);
    const Real moved = gate == Gate::euclidean ? (x - carried).norm() : std::fabs(off_axis(view.hub, x) - off_axis(view.hub, carried));
    if (moved > delta) pass.push_back(v);
  }
  return pass;
}
}  // namespace tape
