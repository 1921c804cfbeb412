#include "tape/cutting/outline.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <polyclipping/clipper.hpp>
#include <set>
#include <utility>

#include "tape/cutting/place.hpp"

namespace tape {
namespace {
using ClipperLib::cInt;
using ClipperLib::IntPoint;
using ClipperLib::Path;
using ClipperLib::Paths;
constexpr Real kMitreLimit = 2;  // times width/2; sharper corners are squared

/// The integer grid that polygons are clipped on: as fine as doubles of the size of the patch.
class Raster {
 public:
  Raster(const Vec2& low, const Vec2& high) : origin_((low + high) / 2) {
    int exponent;
    std::frexp((high - low).maxCoeff(), &exponent);
    bits_ = 52 - exponent;
  }
  IntPoint at(const Vec2& p) const { return {integer(p.x() - origin_.x()), integer(p.y() - origin_.y())}; }
  Vec2 point(const IntPoint& p) const {
    return origin_ + Vec2(std::ldexp(static_cast<Real>(p.X), -bits_), std::ldexp(static_cast<Real>(p.Y), -bits_));
  }
  Real length(Real metres) const { return std::ldexp(metres, bits_); }

 private:
  cInt integer(Real metres) const { return std::llround(std::ldexp(metres, bits_)); }
  Vec2 origin_;
  int bits_;
};

Raster raster_for(const StripMesh& mesh, const Patch& patch, const Line& line, Real width) {
  Vec2 low = line.front(), high = line.front();
  const auto include = [&](const Vec2& p) { low = low.cwiseMin(p), high = high.cwiseMax(p); };
  for (const Vec2& p : line) include(p);
  for (const Index2& e : patch.border) include(mesh.rest[e[0]]);
  const Vec2 reach = Vec2::Constant(kMitreLimit * width);
  return {low - reach, high + reach};
}

Paths thickened(const Raster& raster, const Line& line, Real width) {
  Path path;
  for (const Vec2& p : line) path.push_back(raster.at(p));
  ClipperLib::ClipperOffset offset(kMitreLimit);
  offset.AddPath(path, ClipperLib::jtMiter, ClipperLib::etOpenButt);
  Paths kerf;
  offset.Execute(kerf, raster.length(width / 2));
  return kerf;
}

/// The border of the patch as closed loops of vertices.
std::vector<std::vector<int>> border_loops(const Patch& patch) {
  std::multimap<int, int> next;
  for (const Index2& e : patch.border) next.insert({e[0], e[1]});
  std::vector<std::vector<int>> loops;
  while (!next.empty()) {
    std::vector<int>& loop = loops.emplace_back();
    for (auto it = next.begin(); it != next.end(); it = next.find(loop.back())) {
      if (loop.empty()) loop.push_back(it->first);
      loop.push_back(it->second);
      next.erase(it);
    }
    loop.pop_back();  // where it began
  }
  return loops;
}

Real shoelace(const std::vector<Vec2>& p, const std::vector<int>& loop) {
  Real twice = 0;
  for (std::size_t i = 1; i + 1 < loop.size(); ++i) twice += turn(p[loop[0]], p[loop[i]], p[loop[i + 1]]);
  return twice / 2;
}
Real perimeter(const std::vector<Vec2>& p, const std::vector<int>& loop) {
  Real sum = 0;
  for (std::size_t i = 0; i < loop.size(); ++i) sum += (p[loop[i]] - p[loop[(i + 1) % loop.size()]]).norm();
  return sum;
}

class OutlineMaker {
 public:
  OutlineMaker(const StripMesh& mesh, const Patch& patch, const OutlineLimits& limits) : mesh_(mesh), patch_(patch), limits_(limits) {
    for (const Index2& e : patch.border)
      if (patch.held[e[0]] && patch.held[e[1]]) seam_.insert({e[0], e[1]});
  }

  Outline make(const Line& line, Real width) {
    clip(line, width);
    for (std::vector<int>& loop : loops_) clean(loop);
    std::erase_if(loops_, [&](const std::vector<int>& loop) { return is_hair(loop); });
    removed_ = area_of_patch();
    for (const std::vector<int>& loop : loops_) removed_ -= shoelace(points_, loop);
    check_seam();
    check_width();
    for (std::vector<int>& loop : loops_) divide(loop);
    return outline();
  }

 private:
  bool held(int i) const { return vertex_[i] >= 0 && patch_.held[vertex_[i]]; }
  bool is_seam(int a, int b) const { return seam_.contains({vertex_[a], vertex_[b]}); }
  const Vec2& point(int i) const { return points_[i]; }
  int add(const Vec2& p, int vertex) {
    points_.push_back(p);
    vertex_.push_back(vertex);
    return static_cast<int>(points_.size()) - 1;
  }
  void refuse(const std::string& reason) {
    if (refusal_.empty()) refusal_ = reason;
  }

  void clip(const Line& line, Real width) {
    const Raster raster = raster_for(mesh_, patch_, line, width);
    round_off_ = 64 / raster.length(1);
    std::map<std::pair<cInt, cInt>, int> vertex_at;
    ClipperLib::Clipper clipper;
    clipper.PreserveCollinear(true);
    for (const std::vector<int>& loop : border_loops(patch_)) {
      Path path;
      for (int v : loop) {
        path.push_back(raster.at(mesh_.rest[v]));
        vertex_at[{path.back().X, path.back().Y}] = v;
      }
      clipper.AddPath(path, ClipperLib::ptSubject, true);
    }
    clipper.AddPaths(thickened(raster, line, width), ClipperLib::ptClip, true);
    Paths left;
    clipper.Execute(ClipperLib::ctDifference, left, ClipperLib::pftNonZero, ClipperLib::pftNonZero);

    std::map<int, int> index;  // of a vertex that loops have met before
    for (const Path& path : left) {
      std::vector<int>& loop = loops_.emplace_back();
      for (const IntPoint& p : path) {
        const auto it = vertex_at.find({p.X, p.Y});
        if (it == vertex_at.end()) {
          loop.push_back(add(raster.point(p), -1));
        } else {
          const auto [known, fresh] = index.insert({it->second, 0});
          if (fresh) known->second = add(mesh_.rest[it->second], it->second);
          loop.push_back(known->second);
        }
      }
    }
  }

  /// Removes what sides do not need: points within rounding of their neighbours or of the line between them, and new points at edges
  /// that are too short, where that takes material away.
  void clean(std::vector<int>& loop) const {
    for (bool short_edges : {false, true})
      for (bool changed = true; changed;) {
        changed = false;
        for (std::size_t i = 0; i < loop.size() && loop.size() >= 3;) {
          const int before = loop[(i + loop.size() - 1) % loop.size()], after = loop[(i + 1) % loop.size()];
          const bool drop = !held(loop[i]) && (is_needless(before, loop[i], after) || (short_edges && may_widen(before, loop[i], after)));
          if (drop) loop.erase(loop.begin() + static_cast<std::ptrdiff_t>(i)), changed = true;
          if (!drop) ++i;
        }
      }
  }
  bool is_needless(int a, int b, int c) const {
    return (point(a) - point(b)).norm() <= round_off_ || distance_to_segment(point(b), point(a), point(c)) <= round_off_;
  }
  bool may_widen(int a, int b, int c) const {
    const bool too_short = std::min((point(a) - point(b)).norm(), (point(c) - point(b)).norm()) < limits_.shortest;
    return too_short && vertex_[b] < 0 && turn(point(a), point(b), point(c)) > 0;
  }
  bool is_hair(const std::vector<int>& loop) const {
    if (std::any_of(loop.begin(), loop.end(), [&](int i) { return held(i); })) return false;
    const Real area = shoelace(points_, loop);
    return loop.size() < 3 || (area >= 0 && area < limits_.hair * perimeter(points_, loop) / 2);
  }
  Real area_of_patch() const {
    Real sum = 0;
    for (int t : patch_.triangles) sum += corners(mesh_, t).area();
    return sum;
  }

  /// The border to the rest of the mesh must have come through.
  void check_seam() {
    std::size_t found = 0;
    for (const std::vector<int>& loop : loops_)
      for (std::size_t i = 0; i < loop.size(); ++i) found += is_seam(loop[i], loop[(i + 1) % loop.size()]);
    if (found != seam_.size()) refuse("the kerf reaches beyond the patch that it was to stay in");
  }
  /// No point may be too near to a side that it is not on.
  void check_width() {
    for (const std::vector<int>& loop : loops_)
      for (int p : loop) {
        if (held(p)) continue;
        for (const std::vector<int>& other : loops_)
          for (std::size_t i = 0; i < other.size(); ++i) {
            const int a = other[i], b = other[(i + 1) % other.size()];
            const bool incident = a == p || b == p;
            const Real distance = incident ? (point(b) - point(a)).norm() : distance_to_segment(point(p), point(a), point(b));
            if (distance < limits_.shortest)
              return refuse("a part or a gap narrower than " + length_text(limits_.shortest) + " would be left at " + point_text(point(p)));
          }
      }
  }

  /// Points along the straight sides of a loop: vertices that were there if they stand well, new ones where the gaps are wide.
  void divide(std::vector<int>& loop) {
    std::vector<int> divided;
    for (std::size_t i = 0; i < loop.size(); ++i) {
      const int a = loop[i], b = loop[(i + 1) % loop.size()];
      divided.push_back(a);
      if (is_seam(a, b)) continue;
      int last = a;
      for (int v : vertices_on(point(a), point(b))) {
        const Vec2& p = mesh_.rest[v];
        if (std::min((p - point(last)).norm(), (p - point(b)).norm()) < 0.6 * limits_.spacing) continue;
        fill(divided, last, p);
        divided.push_back(last = add(p, v));
      }
      fill(divided, last, point(b));
    }
    loop = std::move(divided);
  }
  void fill(std::vector<int>& loop, int last, const Vec2& to) {
    const Vec2 start = point(last), end = to;  // copies: add() may move the points
    const int parts = std::max(1, static_cast<int>(std::round((end - start).norm() / limits_.spacing - 0.1)));
    for (int k = 1; k < parts; ++k) loop.push_back(add(start + (end - start) * k / parts, -1));
  }
  /// Old vertices between the ends of a side, in order.
  std::vector<int> vertices_on(const Vec2& a, const Vec2& b) const {
    std::vector<std::pair<Real, int>> found;
    for (const Index2& e : patch_.border) {
      const Vec2& p = mesh_.rest[e[0]];
      const Real at = (p - a).dot(b - a) / (b - a).squaredNorm();
      if (at > 0 && at < 1 && distance_to_segment(p, a, b) <= round_off_) found.push_back({at, e[0]});
    }
    std::sort(found.begin(), found.end());
    std::vector<int> vertices;
    for (const auto& [at, v] : found) vertices.push_back(v);
    return vertices;
  }

  /// The points that the loops still have.
  Outline outline() const {
    Outline out{refusal_, {}, {}, {}, {}, removed_};
    std::vector<int> index(points_.size(), -1);
    for (const std::vector<int>& loop : loops_) {
      for (int i : loop) {
        if (index[i] >= 0) continue;
        index[i] = static_cast<int>(out.points.size());
        out.points.push_back(points_[i]);
        out.vertex.push_back(vertex_[i]);
      }
      for (std::size_t i = 0; i < loop.size(); ++i) {
        const int a = loop[i], b = loop[(i + 1) % loop.size()];
        out.sides.push_back({index[a], index[b]});
        out.seam.push_back(is_seam(a, b));
      }
    }
    return out;
  }

  const StripMesh& mesh_;
  const Patch& patch_;
  const OutlineLimits& limits_;
  std::set<std::pair<int, int>> seam_;  // vertices of the mesh
  std::vector<Vec2> points_;
  std::vector<int> vertex_;  // of the mesh
  std::vector<std::vector<int>> loops_;
  std::string refusal_;
  Real removed_ = 0;    // [m^2]
  Real round_off_ = 0;  // [m]
};
}  // namespace

Patch make_patch(const StripMesh& mesh, std::vector<int> triangles) {
  Patch patch{std::move(triangles), {}, std::vector<char>(mesh.rest.size(), 0)};
  std::vector<char> inside(mesh.triangles.size(), 0);
  std::set<std::pair<int, int>> edges;
  for (int t : patch.triangles) {
    inside[t] = 1;
    for (int k = 0; k < 3; ++k) edges.insert({mesh.triangles[t][k], mesh.triangles[t][(k + 1) % 3]});
  }
  for (const auto& [a, b] : edges)
    if (!edges.contains({b, a})) patch.border.push_back({a, b});
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    if (!inside[t])
      for (int v : mesh.triangles[t]) patch.held[v] = 1;
  return patch;
}

Outline without_kerf(const StripMesh& mesh, const Patch& patch, const Line& line, Real width, const OutlineLimits& limits) {
  return OutlineMaker(mesh, patch, limits).make(line, width);
}
}  // namespace tape
