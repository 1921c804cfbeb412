#pragma once
#include <algorithm>

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
  Span<const int> leader;  ///< [objects] free vertex from which pairs inside the object are seen, -1 if it has none
  int materials;
  Real dhat;   ///< [m] reach of vertex-triangle pairs beyond xi
  Real guard;  ///< [m] reach of the barrier of edge-edge pairs and between a rim and an open surface
  TAPE_HD Real xi(const SurfaceEdge& e) const { return std::max(vertices[e.v[0]].xi, vertices[e.v[1]].xi); }
  TAPE_HD Real xi(const SurfaceTriangle& t) const {
    return std::max(vertices[t.v[0]].xi, std::max(vertices[t.v[1]].xi, vertices[t.v[2]].xi));
  }
  TAPE_HD int interface(int v, int w) const { return vertices[v].material * materials + vertices[w].material; }
  /// The pair of vertex v and triangle t with its constants.
  TAPE_HD ContactPair vertex_triangle(int v, int t) const {
    const SurfaceVertex& a = vertices[v];
    const SurfaceTriangle& b = triangles[t];
    return {.v = {v, b.v[0], b.v[1], b.v[2]},
            .kind = PairKind::vertex_triangle,
            .interface = interface(v, b.v[0]),
            .xi = a.xi + xi(b),
            .dhat = a.rim && b.open ? guard : dhat,
            .weight = std::min(a.area, b.mean_area),
            .mollifier = 0,
            .sharing = b.sharing,
            .triangle = t};
  }
  /// A sample of a triangle that is cut into n^2 equal ones, at the centroid of one of them, and triangle t.
  TAPE_HD SamplePair sample_triangle(int sample, int t, int n) const {
    const SurfaceTriangle &a = triangles[sample / (n * n)], &b = triangles[t];
    SamplePair p{.v = {a.v[0], a.v[1], a.v[2], b.v[0], b.v[1], b.v[2]},
                 .w = {},
                 .interface = interface(a.v[0], b.v[0]),
                 .xi = xi(a) + xi(b),
                 .area = a.area / (n * n),
                 .id = {sample, t}};
    // Row r, counted from the first corner, holds 2 r + 1 of them: those that stand as the whole does, and upside down in between.
    const int k = sample % (n * n);
    int r = 0;
    while ((r + 1) * (r + 1) <= k) ++r;
    const int place = k - r * r, column = place / 2;
    const bool turned = place % 2 == 1;
    p.w[2] = (column + (turned ? 2.0 : 1.0) / 3) / n;
    p.w[0] = 1 - (r + (turned ? 1.0 : 2.0) / 3) / n;
    p.w[1] = 1 - p.w[0] - p.w[2];
    return p;
  }
};

/// Trust box of a vertex in the world, and the one seen from the leader of its object (the same without a leader).
struct Trust {
  Box world, inner;
};
/// Ball around a trust box: the vertex stays within `radius` of `centre`; seen from the leader within `inner_radius` of a point that
/// is as far from `centre` for all vertices of the object.
struct Ball {
  Vec3 centre;                ///< [m]
  Real radius, inner_radius;  ///< [m]
};
/// Path of a vertex that stands for itself, seen from another that has moved by `shift` [m] since the rebuild.
TAPE_HD inline VertexPath seen_from(const VertexPath& leader, const Vec3& shift, VertexPath path) {
  path.centre -= shift;
  path.velocity -= leader.velocity;
  return path;
}
struct MakeTrust {
  SurfaceView s;
  PathView paths;
  Real margin;
  Span<Trust> trust;
  Span<Ball> ball;
  TAPE_HD void operator()(int v) const {
    const Box path = path_box(paths[v]);
    const int leader = s.leader[s.vertices[v].object];
    Trust& t = trust[v];
    t.world = paths.owner[v].block < 0 ? path : inflated(path, margin);
    t.inner = leader < 0 ? t.world : inflated(path_box(seen_from(paths[leader], Vec3::Zero(), paths[v])), margin);
    ball[v] = {t.world.centre(), t.world.radius(), t.inner.radius()};
  }
};
struct StoreLeaders {
  SurfaceView s;
  PathView paths;
  Span<Vec3> start;
  TAPE_HD void operator()(int object) const {
    if (s.leader[object] >= 0) start[object] = paths.x[s.leader[object]];
  }
};
struct InTrust {
  SurfaceView s;
  PathView paths;
  Span<const Trust> trust;
  Span<const Vec3> leader_start;  ///< [objects] m, at the rebuild
  TAPE_HD bool operator()(int v) const {
    if (!trust[v].world.contains(path_box(paths[v]))) return false;
    const int object = s.vertices[v].object, leader = s.leader[object];
    if (leader < 0) return true;
    return trust[v].inner.contains(path_box(seen_from(paths[leader], paths.x[leader] - leader_start[object], paths[v])));
  }
};
struct And {
  TAPE_HD bool operator()(bool a, bool b) const { return a && b; }
};
struct Plus {
  TAPE_HD int operator()(int a, int b) const { return a + b; }
};

/// Primitives as a query looks at them: at the centres of the balls, with all that the decision needs in one place.
struct EdgeShape {
  Vec3 middle, half;  ///< [m] end points are middle -+ half
  Real reach;         ///< [m] two edges that are farther apart than their reaches together never come within the guard's reach
  Real inner_reach;   ///< [m] the same for two edges of one object
  int v[2], carrier, object;
};
struct TriangleShape {
  Vec3 x[3];                ///< [m]
  Vec3 normal;              ///< unit, or zero without area
  Real reach, inner_reach;  ///< [m]
  int v[3], carrier, object;
};
/// Covers the rounding of the tests below, which is some 1e-16 of the coordinates.
inline constexpr Real kRounding = 1e-9;

struct MakeEdges {
  SurfaceView s;
  Span<const Trust> trust;
  Span<const Ball> ball;
  Span<Lanes> boxes;
  Span<EdgeShape> shapes;
  TAPE_HD void operator()(int i) const {
    const SurfaceEdge& e = s.edges[i];
    const Ball &b0 = ball[e.v[0]], &b1 = ball[e.v[1]];
    const Real beyond = s.xi(e) + s.guard / 2;
    shapes[i] = {.middle = 0.5 * (b0.centre + b1.centre),
                 .half = 0.5 * (b1.centre - b0.centre),
                 .reach = (std::max(b0.radius, b1.radius) + beyond) * (1 + kRounding),
                 .inner_reach = (std::max(b0.inner_radius, b1.inner_radius) + beyond) * (1 + kRounding),
                 .v = {e.v[0], e.v[1]},
                 .carrier = s.edge_carrier[i],
                 .object = s.vertices[e.v[0]].object};
    boxes[i] = stored_box(inflated(joined(trust[e.v[0]].world, trust[e.v[1]].world), beyond), i, s.edge_carrier[i] == kFixed);
  }
};
struct MakeTriangles {
  SurfaceView s;
  Span<const Trust> trust;
  Span<const Ball> ball;
  Span<Lanes> boxes;
  Span<TriangleShape> shapes;
  TAPE_HD void operator()(int i) const {
    const SurfaceTriangle& t = s.triangles[i];
    const Ball &b0 = ball[t.v[0]], &b1 = ball[t.v[1]], &b2 = ball[t.v[2]];
    const Real beyond = s.xi(t) + s.dhat / 2;
    shapes[i] = {.x = {b0.centre, b1.centre, b2.centre},
                 .normal = (b1.centre - b0.centre).cross(b2.centre - b0.centre).normalized(),
                 .reach = (std::max(b0.radius, std::max(b1.radius, b2.radius)) + beyond) * (1 + kRounding),
                 .inner_reach = (std::max(b0.inner_radius, std::max(b1.inner_radius, b2.inner_radius)) + beyond) * (1 + kRounding),
                 .v = {t.v[0], t.v[1], t.v[2]},
                 .carrier = s.triangle_carrier[i],
                 .object = s.vertices[t.v[0]].object};
    const Box all = joined(trust[t.v[0]].world, joined(trust[t.v[1]].world, trust[t.v[2]].world));
    boxes[i] = stored_box(inflated(all, beyond), i, s.triangle_carrier[i] == kFixed);
  }
};

/// Finds the triangles that a vertex may touch.
struct VertexQuery {
  SurfaceView s;
  Span<const Trust> trust;
  Span<const Ball> ball;
  Span<const TriangleShape> triangles;
  TreeView tree;
  template <class F>
  TAPE_HD void visit(int v, F&& f) const {
    const int carrier = s.vertex_carrier[v], object = s.vertices[v].object;
    const Real beyond = s.vertices[v].xi + s.dhat / 2, reach = ball[v].radius + beyond, inner_reach = ball[v].inner_radius + beyond;
    const Vec3 centre = ball[v].centre;
    tree.visit(query_box(inflated(trust[v].world, beyond), 0, carrier == kFixed), [&](int t) {
      const TriangleShape& b = triangles[t];
      const bool apart = v != b.v[0] && v != b.v[1] && v != b.v[2] && (carrier == kFree || carrier != b.carrier);
      if (apart && near(centre, b, object == b.object ? std::min(inner_reach + b.inner_reach, reach + b.reach) : reach + b.reach)) f(t);
    });
  }
  TAPE_HD static bool near(const Vec3& centre, const TriangleShape& b, Real range) {
    if (std::fabs(b.normal.dot(centre - b.x[0])) > range) return false;
    const Vec3 x[4] = {centre, b.x[0], b.x[1], b.x[2]};
    return combine(closest_vertex_triangle(x).weight, x).squaredNorm() <= range * range;
  }
  TAPE_HD ContactPair pair(int v, int t) const { return s.vertex_triangle(v, t); }
};

/// Finds the triangles that a sample may stick to, where everything is within the trust boxes.
struct SampleQuery {
  SurfaceView s;
  TreeView tree;
  Span<const Vec3> x;
  /// Calls f(pair, distance [m]) for each triangle within dhat of touching the sample, in no order.
  template <class F>
  TAPE_HD void visit(int sample, int n, F&& f) const {
    const int own = sample / (n * n), carrier = s.triangle_carrier[own];
    const SurfaceTriangle& a = s.triangles[own];
    const Vec3 point = s.sample_triangle(sample, own, n).point(x);
    tree.visit(query_box(inflated(Box{point, point}, s.xi(a) + s.dhat / 2), 0, carrier == kFixed), [&](int t) {
      const SurfaceTriangle& b = s.triangles[t];
      if (carrier != kFree && carrier == s.triangle_carrier[t]) return;
      for (int v : a.v)
        for (int w : b.v)
          if (v == w) return;
      const Vec3 at[4] = {point, x[b.v[0]], x[b.v[1]], x[b.v[2]]};
      const Real d = combine(closest_vertex_triangle(at).weight, at).norm();
      if (d < s.xi(a) + s.xi(b) + s.dhat) f(s.sample_triangle(sample, t, n), d);
    });
  }
};

/// Finds the edges of higher id that an edge may touch.
struct EdgeQuery {
  SurfaceView s;
  Span<const Trust> trust;
  Span<const EdgeShape> edges;
  TreeView tree;
  template <class F>
  TAPE_HD void visit(int i, F&& f) const {
    const EdgeShape a = edges[i];
    const Box box = inflated(joined(trust[a.v[0]].world, trust[a.v[1]].world), s.xi(s.edges[i]) + s.guard / 2);
    tree.visit(query_box(box, i + 1, a.carrier == kFixed), [&](int j) {
      const EdgeShape& b = edges[j];
      const bool apart = a.v[0] != b.v[0] && a.v[0] != b.v[1] && a.v[1] != b.v[0] && a.v[1] != b.v[1];
      if (apart && (a.carrier == kFree || a.carrier != b.carrier) && near(a, b)) f(j);
    });
  }
  TAPE_HD static bool near(const EdgeShape& a, const EdgeShape& b) {
    const Vec3 offset = a.middle - b.middle, across = a.half.cross(b.half);
    const Real range = a.object == b.object ? std::min(a.inner_reach + b.inner_reach, a.reach + b.reach) : a.reach + b.reach,
               range2 = range * range, height = offset.dot(across);
    if (height * height > range2 * across.squaredNorm()) return false;  // far apart along the common normal
    return !beside(a.half, b.half, offset, range2) && !beside(b.half, a.half, offset, range2);
  }
  /// Whether the part w of the offset across edge a separates the edges by more than the range: the projection of a on w is a
  /// point, that of b has the half-length |w . b| / |w|.
  TAPE_HD static bool beside(const Vec3& a, const Vec3& b, const Vec3& offset, Real range2) {
    const Vec3 w = a.squaredNorm() * offset - a.dot(offset) * a;
    const Real gap = w.dot(offset) - std::fabs(w.dot(b));  // times |w|
    return gap > 0 && gap * gap > range2 * w.squaredNorm();
  }
  TAPE_HD ContactPair pair(int i, int j) const {
    const SurfaceEdge &a = s.edges[i], &b = s.edges[j];
    return {.v = {a.v[0], a.v[1], b.v[0], b.v[1]},
            .kind = PairKind::edge_edge,
            .interface = s.interface(a.v[0], b.v[0]),
            .xi = s.xi(a) + s.xi(b),
            .dhat = s.guard,
            .weight = std::min(a.area, b.area),
            .mollifier = 1e-3 * a.length2 * b.length2,
            .sharing = {}};
  }
};

/// Place of the first of a sorted list of names whose key is not below `key`; its size if there is none.
template <class Name>
TAPE_HD int first_from(Span<const Name> sorted, std::uint64_t key) {
  int low = 0, high = sorted.size;
  while (low < high) {
    const int middle = (low + high) / 2;
    if (sorted[middle].key() < key) {
      low = middle + 1;
    } else {
      high = middle;
    }
  }
  return low;
}
template <class Name>
TAPE_HD bool holds(Span<const Name> sorted, std::uint64_t key) {
  const int at = first_from(sorted, key);
  return at < sorted.size && sorted[at].key() == key;
}
struct MakeBonded {
  SurfaceView s;
  Span<const VertexTriangle> names;
  Span<ContactPair> pairs;
  TAPE_HD void operator()(int i) const {
    pairs[i] = s.vertex_triangle(names[i].vertex, names[i].triangle);
    pairs[i].xi = pairs[i].dhat = 0;
  }
};
struct FlagUnbonded {
  Span<const ContactPair> found;
  Span<const VertexTriangle> bonded;
  Span<int> flag;  ///< [found + 1], the last stays 0
  TAPE_HD void operator()(int i) const {
    flag[i] = i < found.size && (found[i].triangle < 0 || !holds(bonded, found[i].name().key())) ? 1 : 0;
  }
};
struct KeepFlagged {
  Span<const ContactPair> found;
  Span<const int> offset;  ///< scanned flags
  Span<ContactPair> pairs;
  TAPE_HD void operator()(int i) const {
    if (offset[i + 1] > offset[i]) pairs[offset[i]] = found[i];
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
