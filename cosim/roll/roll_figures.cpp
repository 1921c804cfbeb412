#include "cosim/roll/roll_figures.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "tape/step/engagement.hpp"

namespace cosim {
namespace {
/// A strip that is wound on a hub, in a state.
class Roll {
 public:
  Roll(const World& world, const State& state, std::size_t strip)
      : world_(world), state_(state), tape_(world.assembly.strips[strip]), hub_(world.setup.scene.strips[strip].winding->hub) {}

  /// [m] rest coordinate of the last place that adheres to the hub, or to tape that lies on the roll. Tape that adheres to itself elsewhere
  /// does not count.
  Real end() const {
    Real last = 0;
    std::vector<std::pair<Real, Real>> layers;  // [m] inner and outer place of pairs of tape
    for_each_remembered(state_, [&](const auto& pair) {
      if (pair.engagement(adhesion_of(world_, pair)) == 0) return;
      const Index3& face = world_.assembly.triangles[static_cast<std::size_t>(pair.triangle)];
      const int vertex = sticking_vertices(world_, pair)[0];
      if (!part(vertex) || !part(face[0])) return;
      const auto [inner, outer] = std::minmax({along(vertex), start_of(face)});
      if (tape(vertex) && tape(face[0]))
        layers.emplace_back(inner, outer);
      else
        last = std::max(last, outer);
    });
    std::ranges::sort(layers);
    for (const auto& [inner, outer] : layers)
      if (inner <= last) last = std::max(last, outer);
    return last;
  }
  /// Seen along the hub's axis, from the axis.
  Vec2 across(int v) const {
    const Pose& pose = state_.bodies[static_cast<std::size_t>(hub_)].pose;
    const Vec3 p = pose.rotation.transpose() * (state_.x[static_cast<std::size_t>(v)] - pose.position);
    return {p.x(), p.y()};
  }
  Real along(int v) const { return tape(v) ? rest(v).x() : 0; }
  Real start_of(const Index3& triangle) const { return std::min({along(triangle[0]), along(triangle[1]), along(triangle[2])}); }
  /// Vertices of the strip's first edge and of the rows up to `end`, in order.
  std::vector<int> edge(Real end) const {
    Real side = 0;
    for (int v : wound(end)) side = std::min(side, rest(v).y());
    std::vector<int> found;
    for (int v : wound(end))
      if (rest(v).y() < side + 1e-9) found.push_back(v);
    std::stable_sort(found.begin(), found.end(), [&](int a, int b) { return rest(a).x() < rest(b).x(); });
    return found;
  }
  std::vector<int> wound(Real end) const {
    std::vector<int> found;
    for (int v = first(); v < first() + tape_.vertices; ++v)
      if (rest(v).x() <= end) found.push_back(v);
    return found;
  }
  Real mass(int v) const { return world_.assembly.mass[static_cast<std::size_t>(v)]; }
  const Body& hub() const { return world_.setup.scene.bodies[static_cast<std::size_t>(hub_)]; }

 private:
  int first() const { return tape_.first_vertex; }
  const Vec2& rest(int v) const { return world_.assembly.rest[static_cast<std::size_t>(v)]; }
  bool tape(int v) const { return v >= first() && v < first() + tape_.vertices; }
  bool part(int v) const {
    const BodyPart& hub = world_.assembly.bodies[static_cast<std::size_t>(hub_)];
    return tape(v) || (v >= hub.first_vertex && v < hub.first_vertex + hub.vertices);
  }

  const World& world_;
  const State& state_;
  const StripPart& tape_;
  int hub_;
};
}  // namespace

std::vector<std::pair<std::string, Real>> roll_figures(const World& world, const State& state, std::size_t strip) {
  const Roll roll(world, state, strip);
  const Real end = roll.end();
  const Body& hub = roll.hub();
  const MassProperties& ring = *hub.solid;
  const Real density = hub.mass > 0 ? hub.mass / ring.volume : hub.density;
  Real mass = density * ring.volume, inertia = density * (ring.second(0, 0) + ring.second(1, 1));
  for (int v : roll.wound(end)) {
    const Vec2 p = roll.across(v);
    mass += roll.mass(v);
    inertia += roll.mass(v) * p.squaredNorm();
  }
  Real angle = 0, length = 0, last_turn = 0, radius = 0;
  const std::vector<int> edge = roll.edge(end);
  for (std::size_t k = edge.size(); k-- > 1;) {
    const Vec2 a = roll.across(edge[k - 1]), b = roll.across(edge[k]);
    const Real chord = (b - a).norm();
    if (std::fabs(angle) < 2 * std::numbers::pi) last_turn += chord, radius += chord * (a.norm() + b.norm()) / 2;
    angle += std::atan2(a.x() * b.y() - a.y() * b.x(), a.dot(b));
    length += chord;
  }
  const Real pitch = world.setup.scene.strips[strip].winding->pitch;
  return {{"turns", std::fabs(angle) / (2 * std::numbers::pi)},
          {"wound_length_m", length},
          {"outer_radius_m", last_turn > 0 ? radius / last_turn + pitch / 2 : 0},
          {"roll_mass_kg", mass},
          {"roll_inertia_kg_m2", inertia}};
}
}  // namespace cosim
