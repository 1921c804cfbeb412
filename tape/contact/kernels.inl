#pragma once
#include "tape/contact/ccd.hpp"
#include "tape/contact/surface.hpp"
#include "tape/contact/tree.hpp"

/// Kernels of the contact search.
namespace tape::TAPE_SIDE::detail {
inline constexpr int kFree = -1, kFixed = -2;  // a carrier that is not a body

struct SurfaceView {
  Span<const SurfaceVertex> vertices;
  Span<const SurfaceEdge> edges;
  Span<const SurfaceTriangle> triangles;
  Span<const int> vertex_carrier, edge_carrier, triangle_carrier;  ///< body that carries the whole primitive, kFixed or kFree
  int materials;
  Real dhat;  ///< [m]
  TAPE_HD Real xi(const SurfaceEdge& e) const { return std::fmax(vertices[e.v[0]].xi, vertices[e.v[1]].xi); }
  TAPE_HD Real xi(const SurfaceTriangle& t) const {
    return std::fmax(vertices[t.v[0]].xi, std::fmax(vertices[t.v[1]].xi, vertices[t.v[2]].xi));
  }
  TAPE_HD int interface(int v, int w) const {
    const int a = vertices[v].material, b = vertices[w].material;
    return a < b ? a * materials + b : b * materials + a;
  }
};

/// Ball around a trust box: the vertex stays within `radius` of `centre`.
struct Ball {
  Vec3 centre;  ///< [m]
  Real radius;  ///< [m]
};
struct MakeTrust {
  PathView paths;
  Real margin;
  Span<Box> trust;
  Span<Ball> ball;
  TAPE_HD void operator()(int v) const {
    const Box path = path_box(paths[v]);
    trust[v] = paths.owner[v].block < 0 ? path : inflated(path, margin);
    ball[v] = {trust[v].centre(), trust[v].radius()};
  }
};
struct InTrust {
  PathView paths;
  Span<const Box> trust;
  TAPE_HD bool operator()(int v) const { return trust[v].contains(path_box(paths[v])); }
};
struct And {
  TAPE_HD bool operator()(bool a, bool b) const { return a && b; }
};
struct Plus {
  TAPE_HD int operator()(int a, int b) const { return a + b; }
};

TAPE_HD inline Box reach(const SurfaceView& s, Span<const Box> trust, const SurfaceEdge& e) {
  return inflated(joined(trust[e.v[0]], trust[e.v[1]]), s.xi(e) + s.dhat / 2);
}
struct EdgeBoxes {
  SurfaceView s;
  Span<const Box> trust;
  Span<Lanes> boxes;
  TAPE_HD void operator()(int i) const { boxes[i] = stored_box(reach(s, trust, s.edges[i]), i, s.edge_carrier[i] == kFixed); }
};
struct TriangleBoxes {
  SurfaceView s;
  Span<const Box> trust;
  Span<Lanes> boxes;
  TAPE_HD void operator()(int i) const {
    const SurfaceTriangle& t = s.triangles[i];
    const Box b = inflated(joined(trust[t.v[0]], joined(trust[t.v[1]], trust[t.v[2]])), s.xi(t) + s.dhat / 2);
    boxes[i] = stored_box(b, i, s.triangle_carrier[i] == kFixed);
  }
};

/// Finds the triangles that a vertex may touch.
struct VertexQuery {
  SurfaceView s;
  Span<const Box> trust;
  Span<const Ball> ball;
  TreeView tree;
  template <class F>
  TAPE_HD void visit(int v, F&& f) const {
    const int carrier = s.vertex_carrier[v];
    const Lanes query = query_box(inflated(trust[v], s.vertices[v].xi + s.dhat / 2), 0, carrier == kFixed);
    tree.visit(query, [&](int t) {
      if (allowed(v, carrier, t) && near(v, s.triangles[t])) f(t);
    });
  }
  TAPE_HD bool allowed(int v, int carrier, int t) const {
    const SurfaceTriangle& b = s.triangles[t];
    return v != b.v[0] && v != b.v[1] && v != b.v[2] && (carrier == kFree || carrier != s.triangle_carrier[t]);
  }
  TAPE_HD bool near(int v, const SurfaceTriangle& t) const {
    const Ball &b0 = ball[t.v[0]], &b1 = ball[t.v[1]], &b2 = ball[t.v[2]], &b = ball[v];
    const Real range = b.radius + std::fmax(b0.radius, std::fmax(b1.radius, b2.radius)) + s.vertices[v].xi + s.xi(t) + s.dhat;
    const Vec3 x[4] = {b.centre, b0.centre, b1.centre, b2.centre};
    const Vec3 normal = (x[2] - x[1]).cross(x[3] - x[1]);
    const Real height = normal.dot(x[0] - x[1]), range2 = range * range * (1 + 1e-9);
    if (height * height > range2 * normal.squaredNorm()) return false;
    return combine(closest_vertex_triangle(x).weight, x).squaredNorm() <= range2;
  }
  TAPE_HD ContactPair pair(int v, int t) const {
    const SurfaceVertex& a = s.vertices[v];
    const SurfaceTriangle& b = s.triangles[t];
    return {.v = {v, b.v[0], b.v[1], b.v[2]},
            .kind = PairKind::vertex_triangle,
            .interface = s.interface(v, b.v[0]),
            .xi = a.xi + s.xi(b),
            .weight = std::fmin(a.area, b.area),
            .mollifier = 0};
  }
};

/// Finds the edges of higher id that an edge may touch.
struct EdgeQuery {
  SurfaceView s;
  Span<const Box> trust;
  Span<const Ball> ball;
  TreeView tree;
  template <class F>
  TAPE_HD void visit(int i, F&& f) const {
    const int carrier = s.edge_carrier[i];
    const SurfaceEdge a = s.edges[i];
    const Lanes query = query_box(reach(s, trust, a), i + 1, carrier == kFixed);
    tree.visit(query, [&](int j) {
      if (allowed(a, carrier, j) && near(a, s.edges[j])) f(j);
    });
  }
  TAPE_HD bool allowed(const SurfaceEdge& a, int carrier, int j) const {
    const SurfaceEdge& b = s.edges[j];
    const bool apart = a.v[0] != b.v[0] && a.v[0] != b.v[1] && a.v[1] != b.v[0] && a.v[1] != b.v[1];
    return apart && (carrier == kFree || carrier != s.edge_carrier[j]);
  }
  TAPE_HD bool near(const SurfaceEdge& a, const SurfaceEdge& b) const {
    const Ball &a0 = ball[a.v[0]], &a1 = ball[a.v[1]], &b0 = ball[b.v[0]], &b1 = ball[b.v[1]];
    const Real range = std::fmax(a0.radius, a1.radius) + std::fmax(b0.radius, b1.radius) + s.xi(a) + s.xi(b) + s.dhat;
    const Real range2 = range * range * (1 + 1e-9);
    const Vec3 x[4] = {a0.centre, a1.centre, b0.centre, b1.centre};
    if (separated(x[1] - x[0], x[3] - x[2], x[0] + x[1] - x[2] - x[3], range2)) return false;
    return combine(closest_edge_edge(x).weight, x).squaredNorm() <= range2;
  }
  /// Whether the part w across ea of the offset between the mid-points separates the edges by more than the range: the
  /// projection of edge a on w is a point, that of b has the half-length |w . eb| / (2 |w|).
  TAPE_HD static bool separated(const Vec3& ea, const Vec3& eb, const Vec3& offset_twice, Real range2) {
    const Real length2 = ea.squaredNorm();
    const Vec3 w = length2 * offset_twice - ea.dot(offset_twice) * ea;
    const Real apart_twice = w.dot(offset_twice) - std::fabs(w.dot(eb));  // times |w|
    return apart_twice > 0 && apart_twice * apart_twice > 4 * range2 * w.squaredNorm() * (1 + 1e-9);
  }
  TAPE_HD ContactPair pair(int i, int j) const {
    const SurfaceEdge &a = s.edges[i], &b = s.edges[j];
    return {.v = {a.v[0], a.v[1], b.v[0], b.v[1]},
            .kind = PairKind::edge_edge,
            .interface = s.interface(a.v[0], b.v[0]),
            .xi = s.xi(a) + s.xi(b),
            .weight = std::fmin(a.area, b.area),
            .mollifier = 1e-3 * a.length2 * b.length2};
  }
};

struct Fill {
  Span<Real> values;
  Real value;
  TAPE_HD void operator()(int i) const { values[i] = value; }
};
/// touching[a objects + b] becomes 0 when objects a and b have a candidate.
struct MarkTouching {
  Span<const ContactPair> pairs;
  Span<const SurfaceVertex> vertices;
  int objects;
  Span<Real> touching;
  TAPE_HD void operator()(int i) const {
    const int a = vertices[pairs[i].v[0]].object, b = vertices[pairs[i].v[3]].object;
    if (a != b) atomic_min(&touching[a * objects + b], 0.0);
  }
};
/// Lowers the limit of the component of pair i; returns 1 if its CCD was capped.
struct LimitStep {
  Span<const ContactPair> pairs;
  PathView paths;
  CcdSettings settings;
  Span<const SurfaceVertex> vertices;
  Span<const int> component;  ///< [objects] -1: fixed
  Span<Real> limit;           ///< [components]
  TAPE_HD int operator()(int i) const {
    const ContactPair& pair = pairs[i];
    const VertexPath path[4] = {paths[pair.v[0]], paths[pair.v[1]], paths[pair.v[2]], paths[pair.v[3]]};
    const PairStep step = largest_step(pair.kind, path, pair.xi, settings);
    if (step.t < 1) {
      const int a = component[vertices[pair.v[0]].object], b = component[vertices[pair.v[3]].object];
      atomic_min(&limit[a >= 0 ? a : b], step.t);
    }
    return step.capped ? 1 : 0;
  }
};
struct ScaleBlocks {
  Span<const int> block_object, component;
  Span<const Real> limit;
  Span<Vec3> direction;
  TAPE_HD void operator()(int b) const {
    if (b >= block_object.size || block_object[b] < 0) return;
    direction[b] *= limit[component[block_object[b]]];
  }
};
}  // namespace tape::TAPE_SIDE::detail
