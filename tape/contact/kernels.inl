#pragma once
#include <algorithm>
#include <limits>

#include "tape/contact/ccd.hpp"
#include "tape/contact/surface.hpp"
#include "tape/contact/tree.hpp"
#include "tape/core/functors.hpp"

/// Kernels of the contact search.
namespace tape::TAPE_SIDE::detail {
inline constexpr int kFree = -1, kFixed = -2;  // a carrier that is not a body
inline constexpr int kWorld = 0;               // a frame

struct SurfaceView {
  Span<const SurfaceVertex> vertices;
  Span<const SurfaceEdge> edges;
  Span<const SurfaceTriangle> triangles;
  Span<const int> vertex_carrier, edge_carrier, triangle_carrier;  ///< body that carries the whole primitive, kFixed or kFree
  Span<const int> vertex_frame;                                    ///< [nv] frame from which pairs of things that follow it are seen
  Span<const int> lead;     ///< [frames] vertex that the frame goes with, and turns with if a body carries it; none for the world
  Span<const char> member;  ///< [nv] of a cluster
  Span<const char> apart;   ///< [objects objects] 1: never a pair; empty: all may be
  Span<const char> shuns;   ///< [objects] 1: kept apart from all that is outside; empty: none is
  Span<const Real> kappa;   ///< [materials materials] Pa, stiffness of the barrier by interface
  int objects, materials;
  Real dhat;   ///< [m] reach of vertex-triangle pairs beyond xi
  Real guard;  ///< [m] reach of the barrier of edge-edge pairs and between a rim and an open surface
  TAPE_HD Real xi(const SurfaceEdge& e) const { return std::max(vertices[e.v[0]].xi, vertices[e.v[1]].xi); }
  TAPE_HD Real xi(const SurfaceTriangle& t) const {
    return std::max(vertices[t.v[0]].xi, std::max(vertices[t.v[1]].xi, vertices[t.v[2]].xi));
  }
  // Whether all of a primitive belongs to one cluster.
  TAPE_HD bool triangle_sleeps(int t) const { return triangle_carrier[t] >= 0 && member[triangles[t].v[0]] != 0; }
  TAPE_HD bool edge_sleeps(int e) const { return edge_carrier[e] >= 0 && member[edges[e].v[0]] != 0; }
  /// Whether a vertex rests on the cluster of its frame, by the body that carries its whole primitive: it has no pairs with what sleeps
  /// there.
  TAPE_HD bool rests(int v, int carrier) const {
    if (carrier < 0 || vertex_frame[v] == kWorld || member[v] != 0) return false;
    const int first = lead[vertex_frame[v]];
    return member[first] != 0 && vertex_carrier[first] == carrier;
  }
  /// Whether what two vertices belong to is kept apart by somebody else.
  TAPE_HD bool kept_apart(int v, int w) const { return apart.size > 0 && apart[vertices[v].object * objects + vertices[w].object] != 0; }
  TAPE_HD bool shuns_outside(int v) const { return shuns.size > 0 && shuns[vertices[v].object] != 0; }
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
            .kappa = kappa[interface(v, b.v[0])],
            .weight = std::min(a.area, b.mean_area),
            .mollifier = 0,
            .sharing = b.sharing,
            .triangle = t};
  }
  /// A sample of a triangle that is cut into n^2 equal ones, and triangle t.
  TAPE_HD SamplePair sample_triangle(int sample, int t, int n) const {
    const SurfaceTriangle &a = triangles[sample / (n * n)], &b = triangles[t];
    SamplePair p{.v = {a.v[0], a.v[1], a.v[2], b.v[0], b.v[1], b.v[2]},
                 .w = {},
                 .interface = interface(a.v[0], b.v[0]),
                 .xi = xi(a) + xi(b),
                 .area = a.area / (n * n),
                 .id = {sample, t}};
    sample_weights(sample % (n * n), n, p.w);
    return p;
  }
};

/// Box that a vertex stays in, and its ball: never farther than `radius` from `centre`.
struct Trust {
  Box box;
  Vec3 centre;  ///< [m]
  Real radius;  ///< [m]
};
struct MakeFrames {
  SurfaceView s;
  PathView paths;
  Span<const Pose> origin;  ///< [frames] where each was at the rebuild
  Span<FramePath> frames;
  TAPE_HD void operator()(int k) const {
    if (k == kWorld) return;
    const VertexPath lead = paths[s.lead[k]];
    const Pose now = paths.frame(s.lead[k]);
    const Mat3 turn = origin[k].rotation * now.rotation.transpose();
    frames[k] = {lead.centre, lead.velocity, lead.spin, turn, origin[k].position + turn * (lead.centre - now.position)};
  }
};
/// Of a frame that goes with a cluster: its coordinates are those in which the members are at home.
struct Home {
  bool known = false;
  Vec3 centre = Vec3::Zero();  ///< [m] where the cluster's centre of mass is there
};
struct StoreFrames {
  SurfaceView s;
  PathView paths;
  Span<const Home> home;
  Span<Pose> origin;
  TAPE_HD void operator()(int k) const {
    if (k != kWorld) origin[k] = home[k].known ? Pose{Mat3::Identity(), home[k].centre} : paths.frame(s.lead[k]);
  }
};
/// How vertices are looked at: each from its own frame, or all from the world.
struct Viewpoint {
  SurfaceView s;
  PathView paths;
  Span<const FramePath> frames;  ///< empty: the world
  TAPE_HD int frame(int v) const { return frames.size > 0 ? s.vertex_frame[v] : kWorld; }
  TAPE_HD Box box(int v) const {
    const int k = frame(v);
    return k == kWorld ? path_box(paths[v]) : path_box(frames[k], paths[v]);
  }
  /// Whether the vertex cannot move there, so that its box stays what it is.
  TAPE_HD bool still(int v) const {
    const int k = frame(v), carrier = s.vertex_carrier[v];
    if (k == kWorld) return carrier == kFixed;
    return carrier >= 0 && carrier == s.vertex_carrier[s.lead[k]] && s.member[v] == s.member[s.lead[k]];  // what rests on it is not quite
  }
};
struct MakeTrust {
  Viewpoint view;
  Real margin;
  Span<const int> list;
  Span<Trust> trust;
  TAPE_HD void operator()(int k) const {
    const int v = list[k];
    const Box path = view.box(v), box = view.still(v) ? path : inflated(path, margin);
    trust[v] = {box, box.centre(), box.radius()};
  }
};
struct MakeHomeTrust {
  Span<const Vec3> home;
  Span<const int> list;
  Span<Trust> trust;
  TAPE_HD void operator()(int k) const {
    const Vec3& y = home[list[k]];
    trust[list[k]] = {{y, y}, y, 0};
  }
};
struct InTrust {
  Viewpoint own, world;
  Span<const int> list;
  Span<const Trust> own_trust, world_trust;  ///< the second is empty where nothing need be seen from the world
  TAPE_HD bool operator()(int k) const {
    const int v = list[k];
    if (world_trust.size > 0 && !world.still(v) && !world_trust[v].box.contains(world.box(v))) return false;
    return own.frame(v) == kWorld || own.still(v) || own_trust[v].box.contains(own.box(v));
  }
};
/// Primitives as a query looks at them: at the centres of the balls, with all that the decision needs in one place.
struct EdgeShape {
  Vec3 middle, half;  ///< [m] end points are middle -+ half
  Real reach;         ///< [m] two edges that are farther apart than their reaches together never come within the guard's reach
  int v[2], carrier, frame;
};
struct TriangleShape {
  Vec3 x[3];    ///< [m]
  Vec3 normal;  ///< unit, or zero without area
  Real reach;   ///< [m]
  int v[3], carrier, frame;
};
/// Covers the rounding of the tests below, which is some 1e-16 of the coordinates.
inline constexpr Real kRounding = 1e-9;

/// The surface as one viewpoint shows it.
struct Sight {
  Span<const Trust> trust;              ///< [nv]
  Span<const EdgeShape> edges;          ///< [edges]
  Span<const TriangleShape> triangles;  ///< [triangles]
  // Boxes of all places where a primitive can be within half of its reach.
  TAPE_HD Box box(const SurfaceView& s, const SurfaceEdge& e) const {
    return inflated(joined(trust[e.v[0]].box, trust[e.v[1]].box), s.xi(e) + s.guard / 2);
  }
  TAPE_HD Box box(const SurfaceView& s, const SurfaceTriangle& t) const {
    return inflated(joined(trust[t.v[0]].box, joined(trust[t.v[1]].box, trust[t.v[2]].box)), s.xi(t) + s.dhat / 2);
  }
  TAPE_HD Box box(const SurfaceView& s, int vertex) const { return inflated(trust[vertex].box, s.vertices[vertex].xi + s.dhat / 2); }
};
struct MakeEdges {
  SurfaceView s;
  Span<const Trust> trust;
  Span<const int> list;
  Span<EdgeShape> shapes;
  TAPE_HD void operator()(int k) const {
    const int i = list[k];
    const SurfaceEdge& e = s.edges[i];
    const Trust &t0 = trust[e.v[0]], &t1 = trust[e.v[1]];
    shapes[i] = {.middle = 0.5 * (t0.centre + t1.centre),
                 .half = 0.5 * (t1.centre - t0.centre),
                 .reach = (std::max(t0.radius, t1.radius) + s.xi(e) + s.guard / 2) * (1 + kRounding),
                 .v = {e.v[0], e.v[1]},
                 .carrier = s.edge_carrier[i],
                 .frame = s.vertex_frame[e.v[0]]};
  }
};
struct MakeTriangles {
  SurfaceView s;
  Span<const Trust> trust;
  Span<const int> list;
  Span<TriangleShape> shapes;
  TAPE_HD void operator()(int k) const {
    const int i = list[k];
    const SurfaceTriangle& t = s.triangles[i];
    const Trust &t0 = trust[t.v[0]], &t1 = trust[t.v[1]], &t2 = trust[t.v[2]];
    shapes[i] = {.x = {t0.centre, t1.centre, t2.centre},
                 .normal = (t1.centre - t0.centre).cross(t2.centre - t0.centre).normalized(),
                 .reach = (std::max(t0.radius, std::max(t1.radius, t2.radius)) + s.xi(t) + s.dhat / 2) * (1 + kRounding),
                 .v = {t.v[0], t.v[1], t.v[2]},
                 .carrier = s.triangle_carrier[i],
                 .frame = s.vertex_frame[t.v[0]]};
  }
};
/// Boxes of the listed primitives, as a tree stores them.
struct BoxVertices {
  SurfaceView s;
  Sight sight;
  Span<const int> list;
  Span<Lanes> boxes;
  TAPE_HD void operator()(int k) const { boxes[k] = stored_box(sight.box(s, list[k]), list[k], s.vertex_carrier[list[k]] == kFixed); }
};
struct BoxEdges {
  SurfaceView s;
  Sight sight;
  Span<const int> list;
  Span<Lanes> boxes;
  TAPE_HD void operator()(int k) const {
    const int i = list[k];
    boxes[k] = stored_box(sight.box(s, s.edges[i]), i, s.edge_carrier[i] == kFixed);
  }
};
struct BoxTriangles {
  SurfaceView s;
  Sight sight;
  Span<const int> list;
  Span<Lanes> boxes;
  TAPE_HD void operator()(int k) const {
    const int i = list[k];
    boxes[k] = stored_box(sight.box(s, s.triangles[i]), i, s.triangle_carrier[i] == kFixed);
  }
};

/// The box of each object, of all that it may touch from the world's view.
struct BoxObjects {
  SurfaceView s;
  Sight sight;
  Span<const int> first;  ///< [objects + 1] vertex of each object
  Span<Box> boxes;
  TAPE_HD void operator()(int o) const {
    if (first[o] == first[o + 1]) return;
    Box box = sight.box(s, first[o]);
    for (int v = first[o] + 1; v < first[o + 1]; ++v) box = joined(box, sight.box(s, v));
    boxes[o] = box;
  }
};
/// For each object those that it may touch from the world's view: that follow another frame, or none, and whose boxes meet its own.
struct FindPartners {
  SurfaceView s;
  Span<const int> first;
  Span<const char> fixed;  ///< [objects]
  Span<const Box> boxes;
  Span<int> partners;  ///< [objects objects] of object o from objects o on
  Span<int> count;     ///< [objects]
  TAPE_HD bool may_touch(int o, int p) const {
    if (o == p || first[p] == first[p + 1] || (fixed[o] != 0 && fixed[p] != 0)) return false;
    if (s.apart.size > 0 && s.apart[o * s.objects + p] != 0) return false;
    const int frame = s.vertex_frame[first[o]];
    return frame == kWorld || frame != s.vertex_frame[first[p]];
  }
  TAPE_HD void operator()(int o) const {
    int n = 0;
    for (int p = 0; p < s.objects && first[o] < first[o + 1]; ++p)
      if (may_touch(o, p) && meet(boxes[o], boxes[p])) partners[o * s.objects + n++] = p;
    count[o] = n;
  }
};
/// For each partner of an object the box of that part of it which the object's box meets. A vertex of no triangle has no area, and no
/// barrier.
struct BoxMeetings {
  SurfaceView s;
  Sight sight;
  Span<const int> first_triangle;  ///< [objects + 1]
  Span<const int> partners, count;
  Span<const Box> boxes;  ///< [objects]
  Span<Box> meetings;     ///< [objects objects] as partners; of those that do not meet one that meets nothing
  TAPE_HD void operator()(int i) const {
    const int o = i / s.objects;
    if (i % s.objects >= count[o]) return;
    const Real inf = std::numeric_limits<Real>::infinity();
    Box meeting{Vec3::Constant(inf), Vec3::Constant(-inf)};
    for (int t = first_triangle[partners[i]]; t < first_triangle[partners[i] + 1]; ++t) {
      const Box box = sight.box(s, s.triangles[t]);
      if (meet(box, boxes[o])) meeting = joined(meeting, box);
    }
    meetings[i] = meeting;
  }
};
enum class Part { vertex, edge, triangle };
TAPE_HD inline int first_vertex(const SurfaceView& s, Part part, int id) {
  return part == Part::vertex ? id : part == Part::edge ? s.edges[id].v[0] : s.triangles[id].v[0];
}
/// Primitives of objects that are looked at from the world: those that have partners, follow a frame, or touch themselves.
struct FlagLookedAt {
  SurfaceView s;
  Part part;
  bool everywhere;  ///< all are
  Span<const int> list, count;
  Span<const char> has_frame, self;  ///< [objects]
  Span<int> flag;                    ///< [list + 1], the last stays 0
  TAPE_HD void operator()(int k) const {
    flag[k] = 0;
    if (k == list.size) return;
    const int o = s.vertices[first_vertex(s, part, list[k])].object;
    flag[k] = everywhere || count[o] > 0 || has_frame[o] != 0 || self[o] != 0 ? 1 : 0;
  }
};
/// Primitives that may touch something from the world's view, and with `awake` what is seen from its frame and does not sleep.
struct FlagNear {
  SurfaceView s;
  Sight sight;
  Part part;
  bool awake;
  bool everywhere;  ///< all may
  Span<const int> list, count;
  Span<const Box> meetings;  ///< [objects objects]
  Span<const char> self;     ///< [objects] 1: touches itself, from the world's view
  Span<int> flag;            ///< [list + 1], the last stays 0
  TAPE_HD void operator()(int k) const { flag[k] = k < list.size && (everywhere || near(list[k])) ? 1 : 0; }

 private:
  TAPE_HD bool sleeps(int id) const {
    return part == Part::vertex ? s.member[id] != 0 : part == Part::edge ? s.edge_sleeps(id) : s.triangle_sleeps(id);
  }
  TAPE_HD Box box(int id) const {
    return part == Part::vertex ? sight.box(s, id) : part == Part::edge ? sight.box(s, s.edges[id]) : sight.box(s, s.triangles[id]);
  }
  TAPE_HD bool near(int id) const {
    const int v = first_vertex(s, part, id), o = s.vertices[v].object;
    if (self[o] != 0 || (awake && s.vertex_frame[v] != kWorld && !sleeps(id))) return true;
    if (count[o] == 0) return false;
    const Box box = this->box(id);
    for (int k = 0; k < count[o]; ++k)
      if (meet(box, meetings[o * s.objects + k])) return true;
    return false;
  }
};
/// What is flagged, in its order.
template <class T>
struct KeepFlagged {
  Span<const T> found;
  Span<const int> offset;  ///< scanned flags
  Span<T> kept;
  TAPE_HD void operator()(int i) const {
    if (offset[i + 1] > offset[i]) kept[offset[i]] = found[i];
  }
};

/// Where pairs are looked for. What follows frames is seen from its own, what does not from the world; and the first is seen from the
/// world too, for pairs with things that do not follow the same frame. What sleeps in a cluster never pairs with what sleeps there.
struct Trees {
  TreeView own;        ///< of what follows a frame and is awake, as its frame sees it
  TreeView asleep;     ///< of what sleeps, and of what did when the tree was planted, where it is at home
  TreeView rest;       ///< of what follows none
  TreeView outside;    ///< of what follows none and somebody else keeps apart from its like
  TreeView followers;  ///< of what follows a frame, as the world sees it; empty if everything follows one frame, or nothing does
  /// Calls f(id, whether it follows the same frame) for what meets the boxes of one that follows `frame`.
  /// @param shuns   whether it is kept apart from all that is outside
  /// @param sleeps  whether a primitive of this kind does, now
  template <class Sleeps, class F>
  TAPE_HD void visit(int frame, bool awake, bool shuns, const Lanes& own_box, const Lanes& asleep_box, const Lanes& world_box,
                     const Sleeps& sleeps, F&& f) const {
    if (frame != kWorld && awake) {
      own.visit(own_box, [&](int id) { f(id, true); });
      asleep.visit(asleep_box, [&](int id) {
        if (sleeps(id)) f(id, true);
      });
    }
    rest.visit(world_box, [&](int id) { f(id, frame == kWorld); });
    if (!shuns) outside.visit(world_box, [&](int id) { f(id, frame == kWorld); });
    followers.visit(world_box, [&](int id) { f(id, false); });
  }
};

/// Whether primitives of a surface may touch: those that follow the same frame must be near as it sees them, all as the world sees them, if
/// it looks.
struct Nearness {
  SurfaceView s;
  Sight own, world;
  TAPE_HD const Sight& of(bool together, int frame) const { return together && frame != kWorld ? own : world; }
  template <class Near>
  TAPE_HD bool agree(bool together, int frame, const Near& near) const {
    if (together && frame != kWorld && !near(own)) return false;
    return world.trust.size == 0 || near(world);
  }
  TAPE_HD bool vertex_triangle(int v, int t, bool together) const {
    const int carrier = s.vertex_carrier[v], frame = s.vertex_frame[v];
    const TriangleShape& b = of(together, frame).triangles[t];
    if (together != (frame == b.frame) || v == b.v[0] || v == b.v[1] || v == b.v[2]) return false;
    if ((carrier != kFree && carrier == b.carrier) || s.kept_apart(v, b.v[0])) return false;
    return agree(together, frame, [&](const Sight& sight) { return near(v, sight, sight.triangles[t]); });
  }
  TAPE_HD bool near(int v, const Sight& sight, const TriangleShape& b) const {
    const Vec3& centre = sight.trust[v].centre;
    const Real range = sight.trust[v].radius + s.vertices[v].xi + s.dhat / 2 + b.reach;
    if (std::fabs(b.normal.dot(centre - b.x[0])) > range) return false;
    const Vec3 x[4] = {centre, b.x[0], b.x[1], b.x[2]};
    return combine(closest_vertex_triangle(x).weight, x).squaredNorm() <= range * range;
  }
};

/// Finds the triangles that a vertex may touch.
struct VertexQuery {
  Nearness nearness;
  Trees trees;
  Span<const int> list;  ///< vertices
  template <class F>
  TAPE_HD void visit(int k, F&& f) const {
    const SurfaceView& s = nearness.s;
    const int v = list[k], frame = s.vertex_frame[v];
    const auto box = [&](const Sight& sight, bool seen) {
      return seen ? query_box(sight.box(s, v), 0, s.vertex_carrier[v] == kFixed) : empty_query();
    };
    const Lanes own_box = box(nearness.own, frame != kWorld), world_box = box(nearness.world, nearness.world.trust.size > 0);
    const Lanes asleep_box = s.rests(v, s.vertex_carrier[v]) ? empty_query() : own_box;
    const auto sleeps = [&](int t) { return s.triangle_sleeps(t); };
    trees.visit(frame, s.member[v] == 0, s.shuns_outside(v), own_box, asleep_box, world_box, sleeps, [&](int t, bool together) {
      if (nearness.vertex_triangle(v, t, together)) f(t);
    });
  }
  TAPE_HD ContactPair pair(int k, int t) const { return nearness.s.vertex_triangle(list[k], t); }
};

/// Finds the sleeping vertices that a triangle which is awake and follows their frame may touch.
struct SleeperQuery {
  Nearness nearness;
  TreeView asleep;
  Span<const int> list;  ///< triangles
  template <class F>
  TAPE_HD void visit(int k, F&& f) const {
    const SurfaceView& s = nearness.s;
    const int t = list[k];
    if (s.rests(s.triangles[t].v[0], s.triangle_carrier[t])) return;
    asleep.visit(query_box(nearness.own.box(s, s.triangles[t]), 0, s.triangle_carrier[t] == kFixed), [&](int v) {
      if (s.member[v] != 0 && nearness.vertex_triangle(v, t, true)) f(v);
    });
  }
  TAPE_HD ContactPair pair(int k, int v) const { return nearness.s.vertex_triangle(v, list[k]); }
};

/// Finds the triangles that a sample may stick to, where everything is within the trust boxes.
struct SampleQuery {
  SurfaceView s;
  Trees trees;
  Span<const FramePath> frames;  ///< that start at x
  Span<const Vec3> x;
  /// Calls f(pair, distance [m]) for each triangle within dhat of touching the sample, in no order.
  template <class F>
  TAPE_HD void visit(int sample, int n, F&& f) const {
    const int own = sample / (n * n), carrier = s.triangle_carrier[own];
    const SurfaceTriangle& a = s.triangles[own];
    const int frame = s.vertex_frame[a.v[0]];
    const Vec3 point = s.sample_triangle(sample, own, n).point(x);
    const Vec3 seen = frame == kWorld ? point : frames[frame].origin + frames[frame].turn * (point - frames[frame].centre);
    const auto box = [&](const Vec3& at) { return query_box(inflated(Box{at, at}, s.xi(a) + s.dhat / 2), 0, carrier == kFixed); };
    const Lanes own_box = box(seen);
    const auto sleeps = [&](int t) { return s.triangle_sleeps(t); };
    trees.visit(frame, true, false, own_box, own_box, box(point), sleeps, [&](int t, bool together) {
      const SurfaceTriangle& b = s.triangles[t];
      if (together != (frame == s.vertex_frame[b.v[0]])) return;
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

/// Finds the edges of higher id that an edge may touch, and those that sleep whatever their id.
struct EdgeQuery {
  Nearness nearness;
  Trees trees;
  Span<const int> list;  ///< edges
  template <class F>
  TAPE_HD void visit(int k, F&& f) const {
    const SurfaceView& s = nearness.s;
    const int i = list[k], carrier = s.edge_carrier[i], frame = s.vertex_frame[s.edges[i].v[0]];
    const auto box = [&](const Sight& sight, int first, bool seen) {
      return seen ? query_box(sight.box(s, s.edges[i]), first, carrier == kFixed) : empty_query();
    };
    const Lanes own_box = box(nearness.own, i + 1, frame != kWorld);
    const Lanes asleep_box = box(nearness.own, 0, frame != kWorld && !s.rests(s.edges[i].v[0], carrier));
    const Lanes world_box = box(nearness.world, i + 1, nearness.world.trust.size > 0);
    const auto sleeps = [&](int e) { return s.edge_sleeps(e); };
    trees.visit(frame, !s.edge_sleeps(i), s.shuns_outside(s.edges[i].v[0]), own_box, asleep_box, world_box, sleeps,
                [&](int j, bool together) {
                  const Sight& sight = nearness.of(together, frame);
                  const EdgeShape &a = sight.edges[i], &b = sight.edges[j];
                  if (together != (frame == b.frame)) return;
                  if (a.v[0] == b.v[0] || a.v[0] == b.v[1] || a.v[1] == b.v[0] || a.v[1] == b.v[1]) return;
                  if ((carrier != kFree && carrier == b.carrier) || s.kept_apart(a.v[0], b.v[0])) return;
                  if (nearness.agree(together, frame, [&](const Sight& from) { return near(from.edges[i], from.edges[j]); })) f(j);
                });
  }
  TAPE_HD static bool near(const EdgeShape& a, const EdgeShape& b) {
    const Vec3 offset = a.middle - b.middle, across = a.half.cross(b.half);
    const Real range = a.reach + b.reach, range2 = range * range, height = offset.dot(across);
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
  TAPE_HD ContactPair pair(int k, int other) const {
    const SurfaceView& s = nearness.s;
    const int i = std::min(list[k], other), j = std::max(list[k], other);
    const SurfaceEdge &a = s.edges[i], &b = s.edges[j];
    return {.v = {a.v[0], a.v[1], b.v[0], b.v[1]},
            .kind = PairKind::edge_edge,
            .interface = s.interface(a.v[0], b.v[0]),
            .xi = s.xi(a) + s.xi(b),
            .dhat = s.guard,
            .kappa = s.kappa[s.interface(a.v[0], b.v[0])],
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
