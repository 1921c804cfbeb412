#include "tape/step/roll_gaps.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <span>

#include "tape/contact/gap.hpp"
#include "tape/contact/intersection.hpp"
#include "tape/contact/search.hpp"
#include "tape/core/error.hpp"

namespace tape {
namespace {
std::string rounded(Real value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.4g", value);
  return text;
}

class Roll {
 public:
  Roll(const Scene& scene, const Assembly& assembly, const SurfaceMesh& surface, int strip)
      : scene_(scene),
        assembly_(assembly),
        surface_(surface),
        strip_(strip),
        hub_(winding().hub < 0 ? -1 : static_cast<int>(scene.strips.size()) + winding().hub),
        cell_(cell_length(strip_of().mesh, scene.films[static_cast<std::size_t>(strip_of().film)].width)) {}

  bool wound(int v) const { return object(v) == strip_ && along(v) <= winding().wound(); }
  bool first_turn(int v) const { return winding().angle(along(v)) < 2 * std::numbers::pi; }
  /// Between layers, or between a layer and the hub.
  bool holds(std::span<const int> a, std::span<const int> b) const {
    const auto part = [&](int v) { return object(v) == strip_ || object(v) == hub_; };
    return part(a[0]) && part(b[0]);
  }
  /// Whether wound vertex v lies on a triangle of the hub or of the layer below.
  bool lies_on(int v, std::span<const int> triangle) const {
    return first_turn(v) ? object(triangle[0]) == hub_ : object(triangle[0]) == strip_ && along(triangle) < along(v);
  }
  /// [m] reach of a search that finds what every vertex lies on, in a roll that holds together.
  Real reach_below() const { return scene_.dhat() + 2 * winding().pitch; }
  std::string name() const { return "roll '" + strip_of().name + "': "; }
  std::string places(std::span<const int> a, std::span<const int> b) const { return place(a) + " and " + place(b); }
  std::string remedy() const {
    const Real sagitta = winding().radius * (1 - std::cos(cell_ / (2 * winding().radius)));
    return "raise roll.pitch (" + rounded(winding().pitch) + " m) or lower strip.cell_length (" + rounded(cell_) +
           " m: the middles of its chords lie up to " + rounded(sagitta) + " m inside the spiral)";
  }

 private:
  const Strip& strip_of() const { return scene_.strips[static_cast<std::size_t>(strip_)]; }
  const Winding& winding() const { return *strip_of().winding; }
  int object(int v) const { return surface_.vertices[static_cast<std::size_t>(v)].object; }
  Real along(int v) const { return assembly_.rest[static_cast<std::size_t>(v)].x(); }
  Real along(std::span<const int> primitive) const {
    Real sum = 0;
    for (int v : primitive) sum += along(v);
    return sum / static_cast<Real>(primitive.size());
  }
  /// "turn 3.4 (row 215)", "the free end (row 300)" or "the hub".
  std::string place(std::span<const int> primitive) const {
    if (object(primitive[0]) == hub_) return "the hub";
    const Real s = along(primitive), turn = winding().angle(std::min(s, winding().wound())) / (2 * std::numbers::pi);
    const std::string row = " (row " + to_text(std::floor(s / cell_ + 1e-6)) + ")";
    return (s > winding().wound() ? "the free end" : "turn " + to_text(std::floor(100 * turn) / 100)) + row;
  }

  const Scene& scene_;
  const Assembly& assembly_;
  const SurfaceMesh& surface_;
  int strip_, hub_;  // objects of the surface; -1: there is no hub
  Real cell_;        // [m]
};

struct Primitives {
  std::span<const int> a, b;
};
Primitives primitives(const ContactPair& p) {
  const std::size_t n = p.kind == PairKind::vertex_triangle ? 1 : 2;
  return {std::span(p.v).first(n), std::span(p.v).subspan(n)};
}

/// Candidate pairs of the roll: all whose gap is below `reach` [m] are among them.
std::vector<ContactPair> pairs_of(const Roll& roll, const SurfaceMesh& surface, const std::vector<Vec3>& x, Real reach) {
  const on_cpu::Buffer<Vec3> positions(x);
  const on_cpu::Buffer<VertexOwner> owner(std::vector<VertexOwner>(x.size()));  // as if nothing moved
  on_cpu::ContactSearch search(surface, reach, reach);
  search.update({positions.span(), owner.span(), {}, {}}, 0);
  std::vector<ContactPair> pairs;
  for (const ContactPair& p : search.candidates())
    if (const auto [a, b] = primitives(p); roll.holds(a, b)) pairs.push_back(p);
  return pairs;
}

Real gap(const ContactPair& p, const std::vector<Vec3>& x) {
  const auto at = [&](int k) -> const Vec3& { return x[static_cast<std::size_t>(p.v[k])]; };
  const Vec3 y[4] = {at(0), at(1), at(2), at(3)};
  return combine(closest(p.kind, y).weight, y).norm() - p.xi;
}

void require_uncrossed(const Roll& roll, const SurfaceMesh& surface, const std::vector<Vec3>& x) {
  for (const Crossing& c : find_intersections(surface, x, std::numeric_limits<int>::max()).first) {
    const auto& edge = surface.edges[static_cast<std::size_t>(c.edge)].v;
    const auto& triangle = surface.triangles[static_cast<std::size_t>(c.triangle)].v;
    if (roll.holds(edge, triangle)) throw InputError(roll.name() + roll.places(edge, triangle) + " cross: " + roll.remedy());
  }
}

void require_apart(const Roll& roll, const std::vector<ContactPair>& pairs, const std::vector<Vec3>& x) {
  const auto closer = [&](const ContactPair& p, const ContactPair& q) { return gap(p, x) < gap(q, x); };
  const auto closest_pair = std::min_element(pairs.begin(), pairs.end(), closer);
  if (closest_pair == pairs.end() || gap(*closest_pair, x) > 0) return;
  const auto [a, b] = primitives(*closest_pair);
  throw InputError(roll.name() + roll.places(a, b) + " are " + rounded(gap(*closest_pair, x) + closest_pair->xi) +
                   " m apart, their half-thicknesses together are " + rounded(closest_pair->xi) + " m: " + roll.remedy());
}
}  // namespace

RollGaps roll_gaps(const Scene& scene, const Assembly& assembly, const SurfaceMesh& surface, const std::vector<Vec3>& x, int strip) {
  const Roll roll(scene, assembly, surface, strip);
  RollGaps gaps;
  std::vector<Real> below(x.size(), std::numeric_limits<Real>::infinity());  // [m] gap of each vertex to what it lies on
  for (const ContactPair& p : pairs_of(roll, surface, x, roll.reach_below())) {
    const Real g = gap(p, x);
    gaps.smallest = std::min(gaps.smallest, g);
    const auto [a, b] = primitives(p);
    Real& nearest = below[static_cast<std::size_t>(a[0])];
    if (p.kind == PairKind::vertex_triangle && roll.wound(a[0]) && roll.lies_on(a[0], b)) nearest = std::min(nearest, g);
  }
  const StripPart& part = assembly.strips[static_cast<std::size_t>(strip)];
  for (int v = part.first_vertex; v < part.first_vertex + part.vertices; ++v) {
    if (!roll.wound(v)) continue;
    const Real g = below[static_cast<std::size_t>(v)];
    GapsBelow& of = roll.first_turn(v) ? gaps.hub : gaps.layers;
    of.largest = std::max(of.largest, g);
    ++of.vertices;
    of.apart += g > scene.dhat();
  }
  return gaps;
}

void check_rolls(const Scene& scene, const Assembly& assembly, const SurfaceMesh& surface, const std::vector<Vec3>& x) {
  for (std::size_t s = 0; s < scene.strips.size(); ++s) {
    if (!scene.strips[s].winding) continue;
    const Roll roll(scene, assembly, surface, static_cast<int>(s));
    require_uncrossed(roll, surface, x);
    require_apart(roll, pairs_of(roll, surface, x, scene.dhat()), x);
  }
}
}  // namespace tape
