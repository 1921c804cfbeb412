#include "tape/cutting/kerf.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <optional>
#include <set>
#include <utility>

#include "tape/cutting/outline.hpp"
#include "tape/cutting/refine.hpp"
#include "tape/math/plane.hpp"

namespace tape {
namespace {
constexpr Real kRadian = std::numbers::pi / 180;
constexpr Real kGoodAngle = 25 * kRadian;  // [rad] below this a triangle is mended
constexpr Real kStandOff = 0.6;            // cells; vertices inside that are nearer to a side of the outline go
constexpr Real kNothing = 1e-3;            // cells; what is thinner counts as nothing
constexpr Real kRoom = 1.2;                // longest edges of a triangle between the kerf and the rest of the mesh
constexpr Real kWindows[] = {1, 2, 4};     // cells or kerf widths; over which a serration that is too fine is averaged

constexpr Real kAway = 0.5;  // cells or kerf widths, the larger; farther from the blade no line is followed
constexpr Real kTie = 1e-9;  // [rad]
constexpr const char* kCutsNothing = "the line cuts nothing";

/// Connected part of each vertex, numbered by its first vertex; -1 where no triangle is.
std::vector<int> pieces_of(const StripMesh& mesh) {
  std::vector<int> root(mesh.rest.size(), -1);
  const auto find = [&](int v) {
    while (root[v] != v) v = root[v] = root[root[v]];
    return v;
  };
  for (const Index3& t : mesh.triangles)
    for (int v : t) root[v] = v;
  for (const Index3& t : mesh.triangles)
    for (int k = 1; k < 3; ++k) {
      const auto [low, high] = std::minmax({find(t[0]), find(t[k])});
      root[high] = low;
    }
  int pieces = 0;
  std::vector<int> piece(mesh.rest.size(), -1);
  for (int v = 0; v < static_cast<int>(mesh.rest.size()); ++v)
    if (root[v] >= 0) piece[v] = root[v] == v ? pieces++ : piece[find(v)];
  return piece;
}

/// Those of `triangles` that the kerf may meet, and some around.
std::vector<int> triangles_near(const StripMesh& mesh, const std::vector<int>& triangles, const Line& line, Real reach) {
  Vec2 low = line.front(), high = line.front();
  for (const Vec2& p : line) low = low.cwiseMin(p), high = high.cwiseMax(p);
  std::vector<int> near;
  for (int t : triangles) {
    const Corners at = corners(mesh, t);
    const Real limit = reach + kRoom * at.longest_edge();
    const auto is_near = [&](const Vec2& p) {
      return (p.array() >= low.array() - limit).all() && (p.array() <= high.array() + limit).all() && distance_to_line(p, line) < limit;
    };
    if (is_near(at.a) || is_near(at.b) || is_near(at.c)) near.push_back(t);
  }
  return near;
}

/// Of a point that may be outside by rounding.
Place place_within(const StripMesh& mesh, const std::vector<int>& triangles, const Vec2& p) {
  Place place = locate(mesh, triangles, p);
  place.weight = place.weight.cwiseMax(0);
  place.weight /= place.weight.sum();
  return place;
}

std::string degree_text(Real angle) { return to_text(std::round(angle / kRadian * 10) / 10) + " deg"; }

struct Quality {
  Real edge, angle, clearance;  // [m], [rad], [m]
};

/// What is wrong with a triangle; empty: nothing.
std::string flaw_of(const Corners& at, const Quality& least) {
  const auto left = [&](const std::string& what, const std::string& allowed) {
    return what + " would be left at " + point_text(at.a) + " (least: " + allowed + ")";
  };
  if (!(at.area() > 0)) return left("a triangle without area", "more");
  if (at.angle() < least.angle)
    return left("a triangle with an angle of " + degree_text(at.angle()), degree_text(least.angle)) +
           ": the kerf leaves too little, or meets an edge too sharply";
  if (at.shortest_edge() < least.edge) return left("an edge of " + length_text(at.shortest_edge()), length_text(least.edge));
  if (const Real height = 2 * at.area() / at.longest_edge(); height < least.clearance)
    return left("a triangle only " + length_text(height) + " high", length_text(least.clearance));
  return "";
}

/// What is wrong with the triangles from `first` on, or with how any of them meet; empty: nothing.
std::string flaw(const StripMesh& mesh, int first, const Quality& least) {
  std::set<std::pair<int, int>> edges;
  for (const Index3& t : mesh.triangles)
    for (int k = 0; k < 3; ++k)
      if (!edges.insert({t[k], t[(k + 1) % 3]}).second) return "triangles would overlap at " + point_text(mesh.rest[t[k]]);
  for (int t = first; t < static_cast<int>(mesh.triangles.size()); ++t)
    if (std::string reason = flaw_of(corners(mesh, t), least); !reason.empty()) return reason;
  std::vector<char> starts(mesh.rest.size(), 0);
  for (const auto& [a, b] : edges)
    if (!edges.contains({b, a}) && std::exchange(starts[a], 1))
      return "two parts would hang together by one point at " + point_text(mesh.rest[a]);
  return "";
}

Real area(const StripMesh& mesh) {
  Real sum = 0;
  for (int t = 0; t < static_cast<int>(mesh.triangles.size()); ++t) sum += corners(mesh, t).area();
  return sum;
}

Cut refused(const std::string& reason) {
  Cut cut;
  cut.refusal = reason;
  return cut;
}

/// Cuts one mesh along one line or another.
class Cutter {
 public:
  Cutter(const StripMesh& mesh, const std::vector<int>& near, const Kerf& kerf, const KerfParams& params)
      : mesh_(mesh), near_(near), cell_(cell_size(mesh)), width_(kerf.width), clearance_(kerf.clearance), params_(params) {
    shortest_ = std::max(clearance_, std::min(params.min_width * cell_, 0.9 * width_));
  }

  Cut cut(Line line) const {
    line.front() = through_edge(line[0], line[1]);
    line.back() = through_edge(line[line.size() - 1], line[line.size() - 2]);
    const Patch patch = make_patch(mesh_, triangles_near(mesh_, near_, line, width_));
    const Outline outline = without_kerf(mesh_, patch, line, width_, {cell_, shortest_, kNothing * cell_});
    if (outline.removed < kNothing * cell_ * cell_) return refused(kCutsNothing);
    if (!outline.refusal.empty()) return refused(outline.refusal);
    if (outline.sides.empty() && patch.triangles.size() == mesh_.triangles.size()) return refused("nothing would be left");

    Real was = kGoodAngle;
    for (int t : patch.triangles) was = std::min(was, corners(mesh_, t).angle());
    const std::vector<int> inner = inner_vertices(patch, outline);
    std::vector<Vec2> inner_points;
    for (int v : inner) inner_points.push_back(mesh_.rest[v]);
    Fresh fresh{{}, outline.vertex};
    if (!outline.sides.empty()) fresh.is = triangulate(outline, inner_points, was, shortest_);
    if (!outline.sides.empty() && fresh.is.triangles.empty()) return refused("the outline of what is left would cross itself");
    fresh.vertex.insert(fresh.vertex.end(), inner.begin(), inner.end());
    fresh.vertex.resize(fresh.is.points.size(), -1);

    Cut out = assemble(patch, fresh);
    out.kerf_area = outline.removed;
    out.refusal = flaw(out.mesh, out.unchanged, {shortest_, smallest_allowed(was), clearance_});
    if (out && std::fabs(area(out.mesh) + out.kerf_area - area(mesh_)) > 1e-12 * area(mesh_)) out.refusal = "the areas would not add up";
    if (!out) return refused(out.refusal);
    out.line = line;
    out.smallest_angle = fresh.is.smallest_angle / kRadian;
    return out;
  }

 private:
  using ByVertices = std::map<std::array<int, 3>, Index3>;  ///< triangles by their sorted vertices
  struct Fresh {
    Triangulation is;
    std::vector<int> vertex;  // of the old mesh, -1: new
  };
  /// A mesh that was good stays good; one that was not, near that.
  Real smallest_allowed(Real was) const {
    const Real wanted = params_.min_angle * kRadian;
    return was >= wanted ? wanted : 0.75 * was;
  }
  bool inside(const Vec2& p) const { return locate(mesh_, near_, p).inside(); }

  /// An end of the line, moved on if it stops short of an edge of the strip or its flat end would.
  Vec2 through_edge(const Vec2& end, const Vec2& before) const {
    const Vec2 along = (end - before).normalized(), across = width_ / 2 * left_of(along);
    const Real reach = params_.edge_reach * cell_;
    if (inside(end + reach * along)) return end;
    for (Real more : {0.0, reach, reach + width_ / 2, reach + width_}) {
      Vec2 moved = end + more * along;
      if (!inside(moved) && !inside(moved - across) && !inside(moved + across)) return moved;
    }
    return end + (reach + 2 * width_) * along;
  }

  /// Vertices of the patch alone that are well inside the outline.
  std::vector<int> inner_vertices(const Patch& patch, const Outline& outline) const {
    std::vector<char> taken = patch.held;
    for (int v : outline.vertex)
      if (v >= 0) taken[v] = 1;
    std::vector<int> found;
    for (int t : patch.triangles)
      for (int v : mesh_.triangles[t])
        if (!std::exchange(taken[v], 1) && is_well_inside(outline, mesh_.rest[v])) found.push_back(v);
    return found;
  }
  bool is_well_inside(const Outline& outline, const Vec2& p) const {
    bool within = false;  // by the number of sides on a ray
    for (std::size_t s = 0; s < outline.sides.size(); ++s) {
      const Vec2 &a = outline.points[outline.sides[s][0]], &b = outline.points[outline.sides[s][1]];
      if (!outline.seam[s] && distance_to_segment(p, a, b) < kStandOff * cell_) return false;
      if ((a.y() > p.y()) != (b.y() > p.y()) && (turn(a, b, p) > 0) == (b.y() > a.y())) within = !within;
    }
    return within;
  }

  Cut assemble(const Patch& patch, const Fresh& fresh) const {
    Cut out;
    std::vector<char> used(fresh.is.points.size(), 0);
    for (const Index3& t : fresh.is.triangles)
      for (int i : t) used[i] = 1;
    std::vector<char> kept = patch.held;
    for (std::size_t i = 0; i < used.size(); ++i)
      if (used[i] && fresh.vertex[i] >= 0) kept[fresh.vertex[i]] = 1;
    out.new_vertex.assign(mesh_.rest.size(), -1);
    const auto add = [&](const Vec2& p) {
      out.mesh.rest.push_back(p);
      return static_cast<int>(out.mesh.rest.size()) - 1;
    };
    for (std::size_t v = 0; v < kept.size(); ++v)
      if (kept[v]) out.new_vertex[v] = add(mesh_.rest[v]);
    std::vector<int> index(used.size(), -1);
    for (std::size_t i = 0; i < used.size(); ++i)
      if (used[i]) index[i] = fresh.vertex[i] >= 0 ? out.new_vertex[fresh.vertex[i]] : add(fresh.is.points[i]);

    ByVertices triangles;  // of the patch
    for (const Index3& t : fresh.is.triangles) {
      const Index3 v(index[t[0]], index[t[1]], index[t[2]]);
      triangles[sorted(v)] = v;
    }
    keep_diagonals(patch, out, triangles);
    std::vector<char> in_patch(mesh_.triangles.size(), 0);
    for (int t : patch.triangles) in_patch[t] = 1;
    out.new_triangle.assign(mesh_.triangles.size(), -1);
    for (int t = 0; t < static_cast<int>(in_patch.size()); ++t) {
      const Index3 v = renamed(mesh_.triangles[t], out);
      if (in_patch[t] && triangles.erase(sorted(v)) == 0) continue;
      out.new_triangle[t] = static_cast<int>(out.mesh.triangles.size());
      out.mesh.triangles.push_back(v);
      out.source.push_back(t);
    }
    out.unchanged = static_cast<int>(out.mesh.triangles.size());
    for (const auto& [key, v] : triangles) {
      out.mesh.triangles.push_back(v);
      out.source.push_back(locate(mesh_, patch.triangles, corners(out.mesh, static_cast<int>(out.source.size())).centre()).triangle);
    }
    number(out, parents(out, patch));
    return out;
  }
  /// Of two diagonals that are equally good the old one stays.
  void keep_diagonals(const Patch& patch, const Cut& out, ByVertices& triangles) const {
    std::map<std::pair<int, int>, int> facing;  // vertex on the left of an edge, all by their new numbers
    for (int t : patch.triangles) {
      const Index3 v = renamed(mesh_.triangles[t], out);
      for (int k = 0; k < 3; ++k) facing[{v[k], v[(k + 1) % 3]}] = v[(k + 2) % 3];
    }
    const auto angle = [&](int a, int b, int c) { return smallest_angle(out.mesh.rest[a], out.mesh.rest[b], out.mesh.rest[c]); };
    for (const auto& [edge, c] : facing) {
      const auto [a, b] = edge;
      const auto across = facing.find({b, a});
      if (a > b || across == facing.end()) continue;
      const int d = across->second;  // the old pair is abc and bad, the new one may be adc and dbc
      const auto adc = triangles.find(sorted({a, d, c})), dbc = triangles.find(sorted({d, b, c}));
      if (std::min({a, b, c, d}) < 0 || adc == triangles.end() || dbc == triangles.end()) continue;
      if (std::min(angle(a, b, c), angle(b, a, d)) < std::min(angle(a, d, c), angle(d, b, c)) - kTie) continue;
      triangles.erase(adc);
      triangles.erase(dbc);
      triangles[sorted({a, b, c})] = {a, b, c};
      triangles[sorted({b, a, d})] = {b, a, d};
    }
  }
  static Index3 renamed(const Index3& t, const Cut& out) { return {out.new_vertex[t[0]], out.new_vertex[t[1]], out.new_vertex[t[2]]}; }
  static std::array<int, 3> sorted(const Index3& t) {
    std::array<int, 3> key{t[0], t[1], t[2]};
    std::sort(key.begin(), key.end());
    return key;
  }
  std::vector<Place> parents(const Cut& cut, const Patch& patch) const {
    std::vector<Place> parent(cut.mesh.rest.size(), Place{});
    for (int t = 0; t < static_cast<int>(mesh_.triangles.size()); ++t)
      for (int k = 0; k < 3; ++k)
        if (const int v = cut.new_vertex[mesh_.triangles[t][k]]; v >= 0 && parent[v].triangle < 0) parent[v] = {t, Vec3::Unit(k)};
    for (std::size_t v = 0; v < parent.size(); ++v)
      if (parent[v].triangle < 0) parent[v] = place_within(mesh_, patch.triangles, cut.mesh.rest[v]);
    return parent;
  }
  static void number(Cut& out, const std::vector<Place>& parent) {
    const std::vector<int> rank = number_by_x(out.mesh);
    out.parent.resize(parent.size());
    for (std::size_t v = 0; v < parent.size(); ++v) out.parent[rank[v]] = parent[v];
    for (int& v : out.new_vertex)
      if (v >= 0) v = rank[v];
    out.piece = pieces_of(out.mesh);
    out.pieces = *std::max_element(out.piece.begin(), out.piece.end()) + 1;
  }

  const StripMesh& mesh_;
  const std::vector<int>& near_;
  Real cell_, width_, clearance_, shortest_;  // [m]
  const KerfParams& params_;
};

/// The line itself, and what to try if a kerf cannot follow it.
std::vector<Line> lines_to_try(const Line& line, Real tolerance, Real window) {
  std::vector<Line> lines{simplified(line, tolerance)};
  for (Real windows : kWindows) lines.push_back(simplified(averaged(line, windows * window), tolerance));
  return lines;
}
}  // namespace

Real cell_size(const StripMesh& mesh) { return std::sqrt(2 * area(mesh) / static_cast<Real>(mesh.triangles.size())); }

Cut cut_kerf(const StripMesh& mesh, const Line& blade, const Kerf& kerf, const KerfParams& params, int within) {
  require_valid(params, "cut");
  require_valid(kerf, "cut");
  if (kerf.width <= kerf.clearance)
    throw SettingsError("cut.width", to_text(kerf.width), "more than the clearance of " + to_text(kerf.clearance) + " m");
  Line line;
  for (const Vec2& p : blade) {
    if (!p.allFinite()) throw InputError("cut: point " + std::to_string(line.size()) + " of the line is not finite");
    if (line.empty() || p != line.back()) line.push_back(p);
  }
  if (line.size() < 2) return refused("the line is a point");

  const std::vector<int> piece = pieces_of(mesh);
  std::vector<int> candidates;
  for (int t = 0; t < static_cast<int>(mesh.triangles.size()); ++t)
    if (within < 0 || piece[mesh.triangles[t][0]] == piece[mesh.triangles[within][0]]) candidates.push_back(t);
  const Real cell = cell_size(mesh), window = std::max(cell, kerf.width);
  const std::vector<int> near = triangles_near(mesh, candidates, line, 4 * window);
  if (near.empty()) return refused(kCutsNothing);

  const Cutter cutter(mesh, near, kerf, params);
  std::optional<Cut> first;
  for (const Line& followed : lines_to_try(line, params.tolerance * cell, window)) {
    const Real away = deviation(line, followed);
    if (away > kAway * window) break;
    Cut cut = cutter.cut(followed);
    if (cut) cut.deviation = away;
    if (cut) return cut;
    if (!first) first = std::move(cut);
    if (first->refusal == kCutsNothing) break;
  }
  return *first;
}
}  // namespace tape
