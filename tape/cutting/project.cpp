#include "tape/cutting/project.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>
#include <utility>

namespace tape {
namespace {
constexpr Real kAlike = 1e-3;  // cells; rest points nearer than that are the same

/// A stretch of the blade, by its arc length on the plane [m], over one triangle.
struct Stretch {
  Real from, to;
  Vec2 start, end;                      // [m] in the rest plane
  bool leaves_at_start, leaves_at_end;  // through an edge of the strip
};

class Projector {
 public:
  Projector(const StripMesh& mesh, const std::vector<Vec3>& x, const std::vector<Vec3>& blade, const ProjectParams& params)
      : mesh_(mesh), x_(x), blade_(blade), params_(params) {
    for (int t = 0; t < static_cast<int>(mesh.triangles.size()); ++t)
      for (int k = 0; k < 3; ++k) left_[{mesh.triangles[t][k], mesh.triangles[t][(k + 1) % 3]}] = t;
  }

  Projection run(const std::vector<int>& targets, Real overshoot) {
    const std::vector<int> patch = connected_near(targets);
    if (patch.empty()) return refused("the blade is not near the strip");
    Vec3 sum = Vec3::Zero();
    Real size = 0;
    for (int t : patch) sum += normal(t), size += normal(t).norm();
    if (!(sum.norm() >= params_.facing * size)) return refused("the strip is folded where the blade is");
    out_.normal = sum.normalized();
    axis_[0] = out_.normal.unitOrthogonal();
    axis_[1] = out_.normal.cross(axis_[0]);

    std::vector<Stretch> stretches;
    Real along = 0, length = 0;
    for (std::size_t k = 0; k + 1 < blade_.size(); ++k) {
      const Vec2 a = on_plane(blade_[k]), b = on_plane(blade_[k + 1]);
      for (int t : patch)
        if (const auto stretch = over(t, a, b, along)) stretches.push_back(*stretch);
      along += (b - a).norm();
      length += (blade_[k + 1] - blade_[k]).norm();
    }
    if (!(along >= params_.facing * length)) return refused("the blade stands edge-on to the strip");
    if (stretches.empty()) return refused("the blade is not over the strip");
    if (edge_on_) return refused("the strip is folded or stands edge-on under the blade");
    join(stretches);
    if (out_) extend(stretches, along, overshoot);
    return out_;
  }

 private:
  static Projection refused(const std::string& reason) {
    Projection out;
    out.refusal = reason;
    return out;
  }
  const Vec3& corner(int t, int k) const { return x_[mesh_.triangles[t][k]]; }
  /// Twice the area [m^2] of a triangle in the world, along its normal.
  Vec3 normal(int t) const { return (corner(t, 1) - corner(t, 0)).cross(corner(t, 2) - corner(t, 0)); }
  Vec2 on_plane(const Vec3& p) const { return {axis_[0].dot(p - blade_[0]), axis_[1].dot(p - blade_[0])}; }
  bool is_rim(int t, int k) const { return !left_.contains({mesh_.triangles[t][(k + 2) % 3], mesh_.triangles[t][(k + 1) % 3]}); }

  bool is_near(int t) const {
    const Vec3 centre = (corner(t, 0) + corner(t, 1) + corner(t, 2)) / 3;
    Real size = 0;
    for (int k = 0; k < 3; ++k) size = std::max(size, (corner(t, k) - centre).norm());
    for (std::size_t i = 0; i + 1 < blade_.size(); ++i) {
      const Vec3 edge = blade_[i + 1] - blade_[i], from = centre - blade_[i];
      const Real length2 = edge.squaredNorm(), at = length2 > 0 ? std::clamp(from.dot(edge) / length2, 0.0, 1.0) : 0.0;
      if ((from - at * edge).norm() <= params_.reach + size) return true;
    }
    return false;
  }
  std::vector<int> connected_near(const std::vector<int>& targets) const {
    std::vector<char> seen(mesh_.triangles.size(), 0);
    std::vector<int> patch;
    const auto visit = [&](int t) {
      if (!std::exchange(seen[t], 1) && is_near(t)) patch.push_back(t);
    };
    for (int t : targets) visit(t);
    for (std::size_t i = 0; i < patch.size(); ++i)
      for (int k = 0; k < 3; ++k) {
        const Index3& v = mesh_.triangles[patch[i]];
        if (const auto it = left_.find({v[(k + 1) % 3], v[k]}); it != left_.end()) visit(it->second);
      }
    std::sort(patch.begin(), patch.end());
    return patch;
  }

  /// The part of the segment a-b of the blade, `before` along it, over a triangle.
  std::optional<Stretch> over(int t, const Vec2& a, const Vec2& b, Real before) {
    const Vec2 p = on_plane(corner(t, 0)), q = on_plane(corner(t, 1)), r = on_plane(corner(t, 2));
    const Real twice = turn(p, q, r);
    if (twice < params_.facing * normal(t).norm()) {
      edge_on_ = edge_on_ || meet(a, b, p, q) || meet(a, b, q, r) || meet(a, b, r, p);
      return {};
    }
    const Vec3 at_a = barycentric(a, p, q, r), at_b = barycentric(b, p, q, r);
    Real from = 0, to = 1;
    for (int k = 0; k < 3; ++k) {
      const Real rate = at_b[k] - at_a[k];
      if (rate > 0) from = std::max(from, -at_a[k] / rate);
      if (rate < 0) to = std::min(to, -at_a[k] / rate);
      if (rate == 0 && at_a[k] < 0) return {};
    }
    if (!(from < to)) return {};
    const Corners rest = corners(mesh_, t);
    const auto image = [&](const Vec3& w) -> Vec2 { return w[0] * rest.a + w[1] * rest.b + w[2] * rest.c; };
    const auto leaves = [&](const Vec3& w) {
      for (int k = 0; k < 3; ++k)
        if (w[k] < 1e-6 && is_rim(t, k)) return true;
      return false;
    };
    const Vec3 start = at_a + from * (at_b - at_a), end = at_a + to * (at_b - at_a);
    const Real length = (b - a).norm();
    return Stretch{before + from * length, before + to * length, image(start), image(end), leaves(start), leaves(end)};
  }

  static bool meet(const Vec2& a, const Vec2& b, const Vec2& p, const Vec2& q) {
    return turn(a, b, p) * turn(a, b, q) <= 0 && turn(p, q, a) * turn(p, q, b) <= 0;
  }

  /// Strings the stretches together. Two triangles may both have a part of the blade only where they say the same of it.
  void join(std::vector<Stretch>& stretches) {
    std::sort(stretches.begin(), stretches.end(),
              [](const Stretch& s, const Stretch& t) { return std::pair(s.from, s.to) < std::pair(t.from, t.to); });
    const Real alike = kAlike * cell_size(mesh_);
    Real reached = 0;
    for (std::size_t i = 0; i < stretches.size(); ++i) {
      const Stretch& s = stretches[i];
      for (std::size_t j = 0; j < i; ++j)
        if (differ(s, stretches[j], alike)) return void(out_.refusal = "the strip lies under the blade more than once");
      const Real gap = std::max(s.from - reached, Real{0});
      if (i > 0 && (at(s, std::clamp(reached, s.from, s.to)) - out_.line.back()).norm() > gap / params_.facing + cell_size(mesh_))
        return void(out_.refusal = "the strip lies beside itself under the blade");
      for (const Vec2& p : {at(s, std::clamp(reached, s.from, s.to)), s.end})
        if (out_.line.empty() || (p - out_.line.back()).norm() > alike) out_.line.push_back(p);
      reached = std::max(reached, s.to);
    }
    if (out_.line.size() < 2) out_.refusal = "the blade is not over the strip";
  }
  static Vec2 at(const Stretch& s, Real along) { return s.start + (along - s.from) / (s.to - s.from) * (s.end - s.start); }
  static bool differ(const Stretch& s, const Stretch& t, Real alike) {
    const Real from = std::max(s.from, t.from), to = std::min(s.to, t.to);
    return to - from > alike && std::max((at(s, from) - at(t, from)).norm(), (at(s, to) - at(t, to)).norm()) > alike;
  }

  void extend(const std::vector<Stretch>& stretches, Real length, Real overshoot) {
    const Stretch& first = stretches.front();
    const Stretch& last =
        *std::max_element(stretches.begin(), stretches.end(), [](const Stretch& s, const Stretch& t) { return s.to < t.to; });
    Line& line = out_.line;
    const Vec2 before = (line[0] - line[1]).normalized(), after = (line[line.size() - 1] - line[line.size() - 2]).normalized();
    if (first.leaves_at_start && first.from > 0) line.insert(line.begin(), line.front() + std::min(first.from, overshoot) * before);
    if (last.leaves_at_end && last.to < length) line.push_back(line.back() + std::min(length - last.to, overshoot) * after);
  }

  const StripMesh& mesh_;
  const std::vector<Vec3>&x_, &blade_;
  const ProjectParams& params_;
  std::map<std::pair<int, int>, int> left_;  // triangle on the left of an edge
  Vec3 axis_[2];                             // of the plane; its origin is the start of the blade
  bool edge_on_ = false;
  Projection out_;
};
}  // namespace

Projection project_blade(const StripMesh& mesh, const std::vector<Vec3>& x, const std::vector<Vec3>& blade, const std::vector<int>& targets,
                         Real overshoot, const ProjectParams& params) {
  require_valid(params, "cut");
  if (x.size() != mesh.rest.size())
    throw InputError("cut: " + std::to_string(x.size()) + " positions for " + std::to_string(mesh.rest.size()) + " vertices");
  for (const Vec3& p : blade)
    if (!p.allFinite()) throw InputError("cut: the blade is not finite");
  return Projector(mesh, x, blade, params).run(targets, overshoot);
}
}  // namespace tape
