#include "tape/contact/search.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>
#include <tuple>

#include "tests/tape/contact/meshes.hpp"
using namespace tape;
using namespace tape::on_cpu;

namespace {
constexpr Real kDhat = 1.8e-4, kXi = 4.5e-5;  // [m]
using Key = std::tuple<int, int, int, int, int>;

struct Scene {
  explicit Scene(test::Surface s) : surface(std::move(s)), direction(static_cast<std::size_t>(surface.blocks), Vec3(Vec3::Zero())) {}
  const SurfaceMesh& mesh() const { return surface.mesh; }
  void jiggle(Real size, unsigned seed) {  // [m]
    std::mt19937_64 generator(seed);
    std::uniform_real_distribution<Real> u(-size, size);
    for (Vec3& d : direction) d = Vec3(u(generator), u(generator), u(generator));
  }
  PathView paths() {
    device_x.upload(surface.x), device_direction.upload(direction), device_owner.upload(surface.mesh.owner), device_bodies.upload(bodies);
    return {device_x.span(), device_owner.span(), device_direction.span(), device_bodies.span()};
  }
  void move(Real t) {
    const PathView p = paths();
    for (int v = 0; v < p.x.size; ++v) surface.x[static_cast<std::size_t>(v)] = p[v].at(t);
  }
  test::Surface surface;
  std::vector<Vec3> direction;
  std::vector<Pose> bodies;
  Buffer<Vec3> device_x, device_direction;
  Buffer<Pose> device_bodies;
  Buffer<VertexOwner> device_owner;
};

Key key(const ContactPair& p) { return {static_cast<int>(p.kind), p.v[0], p.v[1], p.v[2], p.v[3]}; }
std::set<Key> keys(Span<const ContactPair> pairs) {
  std::set<Key> out;
  for (const ContactPair& p : pairs) out.insert(key(p));
  return out;
}
bool same_carrier(const SurfaceMesh& mesh, const std::vector<int>& v) {
  const auto carrier = [&](int w) {
    const VertexOwner o = mesh.owner[static_cast<std::size_t>(w)];
    return o.block < 0 ? -2 : o.body;
  };
  return carrier(v[0]) != -1 && std::ranges::all_of(v, [&](int w) { return carrier(w) == carrier(v[0]); });
}
/// All admissible pairs of primitives, from the words of surface.hpp.
template <class F>
void all_pairs(const SurfaceMesh& mesh, F&& f) {
  for (int v = 0; v < static_cast<int>(mesh.vertices.size()); ++v)
    for (const SurfaceTriangle& t : mesh.triangles)
      if (v != t.v[0] && v != t.v[1] && v != t.v[2] && !same_carrier(mesh, {v, t.v[0], t.v[1], t.v[2]}))
        f(Key(0, v, t.v[0], t.v[1], t.v[2]));
  for (std::size_t i = 0; i < mesh.edges.size(); ++i)
    for (std::size_t j = i + 1; j < mesh.edges.size(); ++j) {
      const auto &a = mesh.edges[i].v, &b = mesh.edges[j].v;
      if (a[0] != b[0] && a[0] != b[1] && a[1] != b[0] && a[1] != b[1] && !same_carrier(mesh, {a[0], a[1], b[0], b[1]}))
        f(Key(1, a[0], a[1], b[0], b[1]));
    }
}
Real distance(const Key& k, const std::vector<Vec3>& x) {
  const auto [kind, a, b, c, d] = k;
  const auto at = [&](int v) { return x[static_cast<std::size_t>(v)]; };
  const Vec3 y[4] = {at(a), at(b), at(c), at(d)};
  return combine(closest(static_cast<PairKind>(kind), y).weight, y).norm();
}
/// Pairs within xi + dhat at any of nine times along the paths, by trying all; `xi` [m] of both sides together.
std::set<Key> near_pairs(Scene& scene, Real xi, Real dhat) {
  std::set<Key> out;
  for (int k = 0; k <= 8; ++k) {
    Scene moved(scene.surface);
    moved.direction = scene.direction, moved.bodies = scene.bodies;
    moved.move(k / 8.0);
    all_pairs(scene.mesh(), [&](const Key& key) {
      if (distance(key, moved.surface.x) < xi + dhat) out.insert(key);
    });
  }
  return out;
}
void expect_holds_all(const std::set<Key>& found, const std::set<Key>& wanted) {
  EXPECT_FALSE(wanted.empty());
  EXPECT_TRUE(std::ranges::includes(found, wanted));
}
/// A table of two triangles that cannot move, `height` [m] below y = 0.
void add_table(test::Surface& s, Real height) {
  const VertexOwner fixed;
  test::add_object(s, {{-1, -height, -1}, {1, -height, -1}, {1, -height, 1}, {-1, -height, 1}}, {{0, 1, 2}, {0, 2, 3}}, kXi, &fixed);
}
/// A square of two triangles, side 10 mm, at `x` [m] and `y` [m] above the origin.
void add_tile(test::Surface& s, Real x, Real y, const VertexOwner* owner = nullptr) {
  test::add_object(s, {{x, y, 0}, {x + 0.01, y, 0}, {x + 0.01, y, 0.01}, {x, y, 0.01}}, {{0, 1, 2}, {0, 2, 3}}, kXi, owner);
}
}  // namespace

TEST(ContactSearch, CandidatesHoldEveryPairThatComesNearAlongRandomMotion) {
  for (const unsigned seed : {1u, 2u, 3u}) {
    Scene scene(test::scattered_triangles(60, 0.2, 0.01, seed));
    scene.jiggle(0.1, seed);
    ContactSearch search(scene.mesh(), 0.02, 0.02);
    EXPECT_TRUE(search.update(scene.paths(), 0));
    const std::set<Key> found = keys(search.candidates());
    expect_holds_all(found, near_pairs(scene, 0.02, 0.02));
    std::set<Key> admissible;
    all_pairs(scene.mesh(), [&](const Key& k) { admissible.insert(k); });
    EXPECT_TRUE(std::ranges::includes(admissible, found));
    EXPECT_LT(found.size(), admissible.size() / 2) << "nothing was left out";
  }
}

TEST(ContactSearch, PathBoxesAreFiniteHoweverSmallTheTurn) {  // Newton's last updates: a norm underflows before a component does
  for (Real turn : {1e-300, 1e-200, 1e-161, 1e-100, 1e-20, 1e-3}) {
    const VertexPath path{Vec3::Zero(), Vec3(1e-3, 0, 0), Vec3(0, 1, 0), Vec3(0, 0, turn)};
    const Box box = path_box(path);
    ASSERT_TRUE(box.low.allFinite() && box.high.allFinite()) << turn;
    for (Real t : {0.0, 0.5, 1.0}) EXPECT_TRUE(box.contains({path.at(t), path.at(t)})) << turn << " at " << t;
  }
}

TEST(ContactSearch, PathBoxesSeenFromAFrameHoldThePath) {
  std::mt19937_64 generator(1);
  std::uniform_real_distribution<Real> u(-1, 1);
  const auto random = [&](Real size) { return Vec3(size * Vec3(u(generator), u(generator), u(generator))); };
  for (Real spin : {0.0, 1e-161, 1e-3, 0.3, 3.0}) {
    for (int k = 0; k < 50; ++k) {
      const FramePath frame{random(1), random(1), random(spin), rotation_exp(random(3)), random(1)};
      const bool free = k % 2 == 0;
      const VertexPath path{random(1), random(1), free ? Vec3(Vec3::Zero()) : random(1), free ? Vec3(Vec3::Zero()) : random(1)};
      const Box box = inflated(path_box(frame, path), 1e-12);
      for (Real t = 0; t <= 1; t += 1.0 / 64) {
        const Vec3 y = frame.origin + frame.turn * rotate(-t * frame.spin, path.at(t) - frame.centre - t * frame.velocity);
        ASSERT_TRUE(box.contains({y, y})) << "spin " << spin << ", t " << t;
      }
      const VertexPath carried{frame.centre, frame.velocity, random(1), frame.spin};
      EXPECT_LT(path_box(frame, carried).radius(), 1e-14) << "what moves with the frame stands still";
    }
  }
}

TEST(ContactSearch, ARollThatTurnsAndFliesHasTheCandidatesOfOneAtRest) {
  test::Surface roll = test::wound_strip(4, 2.7e-4, kXi);
  const VertexOwner hub{roll.blocks, 0};
  std::vector<Vec3> ring;
  std::vector<Index3> faces;
  constexpr int kSides = 48;
  for (int k = 0; k < kSides; ++k)
    for (Real z : {0.0, 0.019}) {
      const Real angle = 2 * 3.14159265358979323846 * k / kSides;
      ring.emplace_back(20.9e-3 * std::cos(angle), 20.9e-3 * std::sin(angle), z);
    }
  for (int k = 0; k < kSides; ++k) {
    const int a = 2 * k, b = 2 * ((k + 1) % kSides);
    faces.emplace_back(a, b, b + 1), faces.emplace_back(a, b + 1, a + 1);
  }
  test::add_object(roll, ring, faces, 0, &hub);
  roll.blocks += 2;
  roll.mesh.follows = {0, 0};
  std::set<Key> at_rest;
  for (const auto& [spin, flight] : {std::pair(Vec3(0, 0, 0), Vec3(0, 0, 0)), std::pair(Vec3(0, 0, 0.1), Vec3(0.03, -0.02, 0.01))}) {
    Scene scene(roll);
    scene.bodies = {{rotation_exp(Vec3(1, 2, 3)), Vec3(1e-4, 0, 0.01)}};
    scene.jiggle(2e-5, 5);
    const Vec3 centre = scene.bodies[0].position;
    for (std::size_t v = 0; v < roll.x.size(); ++v)
      if (const VertexOwner o = roll.mesh.owner[v]; o.body < 0)
        scene.direction[static_cast<std::size_t>(o.block)] += flight + rotate(spin, roll.x[v] - centre) - (roll.x[v] - centre);
    scene.direction[static_cast<std::size_t>(hub.block)] = flight, scene.direction[static_cast<std::size_t>(hub.block) + 1] = spin;
    ContactSearch search(scene.mesh(), kDhat, kDhat);
    search.update(scene.paths(), 5e-5);
    const std::set<Key> found = keys(search.candidates());
    expect_holds_all(found, near_pairs(scene, 2 * kXi, kDhat));
    if (spin.isZero()) {
      at_rest = found;
    } else {
      EXPECT_LT(found.size(), 3 * at_rest.size()) << "a way of 11 layers";
    }
  }
}

TEST(ContactSearch, CandidatesHoldEveryPairWithWhatSleepsInACluster) {
  constexpr int kColumns = 7;
  for (bool table : {false, true}) {
    Scene scene(test::wound_strip(2, 2.7e-4, kXi));
    test::Surface& s = scene.surface;
    const std::vector<VertexOwner> free = s.mesh.owner;
    const std::vector<Vec3> x = s.x;
    const VertexOwner body{s.blocks, 0};
    s.blocks += 2;
    if (table) add_table(s, 21.8e-3);
    // It turns and flies; its members are at home in another frame.
    const Pose pose{rotation_exp(Vec3(0.3, -0.2, 2)), Vec3(1e-4, 0, 0.01)};
    const Vec3 centre(0.2, 0.1, -0.3), spin(0, 0, 0.02), flight(1e-4, -2e-4, 1e-4);
    scene.bodies = {pose};
    scene.direction.resize(static_cast<std::size_t>(s.blocks), Vec3::Zero());
    scene.jiggle(2e-5, 5);
    for (std::size_t v = 0; v < x.size(); ++v) {
      const Vec3 arm = x[v] - pose.position;
      scene.direction[static_cast<std::size_t>(free[v].block)] += flight + rotate(spin, arm) - arm;
    }
    scene.direction[static_cast<std::size_t>(body.block)] = flight, scene.direction[static_cast<std::size_t>(body.block) + 1] = spin;
    ContactSearch search(scene.mesh(), kDhat, kDhat);
    const int rows = static_cast<int>(x.size()) / kColumns;
    for (int members : {rows - 6, rows - 9, rows / 3, 0}) {  // then some wake, so many that trees are planted anew, and all
      SurfaceCarriage carriage{.owner = s.mesh.owner, .follows = {members > 0 ? 0 : -1}, .home = {}, .clusters = {}};
      if (table) carriage.follows.push_back(-1);
      if (members > 0) carriage.clusters[0] = centre;
      carriage.home.resize(s.x.size(), Vec3::Zero());
      for (std::size_t v = 0; v < x.size(); ++v) {
        carriage.owner[v] = static_cast<int>(v) < kColumns * members ? body : free[v];
        carriage.home[v] = centre + pose.rotation.transpose() * (x[v] - pose.position);
      }
      s.mesh.owner = carriage.owner;
      search.set_carriage(carriage);
      search.update(scene.paths(), 2e-5);
      const std::set<Key> found = keys(search.candidates());
      EXPECT_EQ(found.size(), static_cast<std::size_t>(search.candidates().size)) << "none twice";
      expect_holds_all(found, near_pairs(scene, 2 * kXi, kDhat));
      std::set<Key> admissible;
      all_pairs(scene.mesh(), [&](const Key& k) { admissible.insert(k); });
      EXPECT_TRUE(std::ranges::includes(admissible, found)) << members << " rows sleep";
    }
  }
}

TEST(ContactSearch, CandidatesHoldEveryPairOfRollsAndFolds) {
  for (const test::Surface& s : {test::wound_strip(1.3, 2.7e-4, kXi), test::folded_strip(3, 10, 2.7e-4, kXi)}) {
    Scene scene(s);
    scene.jiggle(1e-4, 5);
    ContactSearch search(scene.mesh(), kDhat, kDhat);
    search.update(scene.paths(), 5e-5);
    expect_holds_all(keys(search.candidates()), near_pairs(scene, 2 * kXi, kDhat));
  }
}

TEST(ContactSearch, AFoldThatFliesFarHasTheCandidatesOfOneThatStays) {
  // Pairs inside an object are seen from it: 0.1 m in a step, and reuse on the way, change nothing but round-off.
  const test::Surface fold = test::folded_strip(3, 10, 2.7e-4, kXi);
  std::set<Key> of_resting;
  for (const Vec3& flight : {Vec3(0, 0, 0), Vec3(0.1, -0.05, 0.02)}) {
    Scene scene(fold);
    scene.jiggle(1e-4, 5);
    for (Vec3& d : scene.direction) d += flight;
    ContactSearch search(scene.mesh(), kDhat, kDhat / 2);
    search.update(scene.paths(), 5e-5);
    const std::set<Key> found = keys(search.candidates());
    std::set<Key> near = near_pairs(scene, 2 * kXi, kDhat);
    std::erase_if(near, [](const Key& k) { return std::get<0>(k) == 1; });
    expect_holds_all(found, near);
    near = near_pairs(scene, 2 * kXi, kDhat / 2);  // edges: the guard
    expect_holds_all(found, near);
    if (flight.isZero()) {
      of_resting = found;
    } else {
      EXPECT_LT(found.size(), 2 * of_resting.size()) << "seen from the world instead of the leader there are forty times as many";
    }
    scene.move(0.5);
    for (Vec3& d : scene.direction) d *= 0.5;
    EXPECT_FALSE(search.update(scene.paths(), 5e-5)) << "half of the way is done, the other half was looked at";
  }
}

TEST(SurfaceMesh, AnObjectKnowsItsRimAndWhatItsTrianglesShare) {
  test::Surface s;  // four triangles around a vertex, and a tetrahedron
  test::add_object(s, {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {-1, 0, 0}, {0, -1, 0}}, {{0, 1, 2}, {0, 2, 3}, {0, 3, 4}, {0, 4, 1}}, 0.01);
  test::add_object(s, {{0, 0, 5}, {3, 0, 5}, {0, 3, 5}, {0, 0, 8}}, {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}}, 0.01);
  const auto& v = s.mesh.vertices;
  EXPECT_FALSE(v[0].rim);
  for (std::size_t k = 1; k < 5; ++k) EXPECT_TRUE(v[k].rim);
  for (std::size_t k = 5; k < 9; ++k) EXPECT_FALSE(v[k].rim);
  const SurfaceTriangle &flat = s.mesh.triangles[0], &closed = s.mesh.triangles[4];
  EXPECT_TRUE(flat.open);
  EXPECT_THAT(flat.sharing.edge, testing::ElementsAre(2, 1, 2));
  EXPECT_THAT(flat.sharing.vertex, testing::ElementsAre(4, 0, 0));
  EXPECT_DOUBLE_EQ(flat.mean_area, 0.5);
  EXPECT_FALSE(closed.open);
  EXPECT_THAT(closed.sharing.edge, testing::ElementsAre(2, 2, 2));
  EXPECT_THAT(closed.sharing.vertex, testing::ElementsAre(3, 3, 3));
  EXPECT_DOUBLE_EQ(closed.mean_area, (3 * 4.5 + 4.5 * std::sqrt(3.0)) / 4);  // three half squares and the slope
  EXPECT_EQ(s.mesh.edges.size(), 8u + 6u);
}
TEST(ContactSearch, EdgesAndRimsOverOpenSurfacesReachAsFarAsTheGuard) {
  test::Surface s;
  const std::vector<Vec3> sheet = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {-1, 0, 0}, {0, -1, 0}};
  std::vector<Vec3> above;
  for (const Vec3& p : sheet) above.push_back(0.5 * p + Vec3(0.01, 0.02, 0.05));
  test::add_object(s, sheet, {{0, 1, 2}, {0, 2, 3}, {0, 3, 4}, {0, 4, 1}}, 0);
  test::add_object(s, above, {{0, 1, 2}, {0, 2, 3}, {0, 3, 4}, {0, 4, 1}}, 0);
  Scene scene(s);
  ContactSearch search(scene.mesh(), 0.1, 0.06);
  search.update(scene.paths(), 0);
  int full = 0, guard = 0;
  for (const ContactPair& p : search.candidates()) {
    const bool inner = p.kind == PairKind::vertex_triangle && (p.v[0] == 0 || p.v[0] == 5);
    EXPECT_EQ(p.dhat, inner ? 0.1 : 0.06);
    ++(inner ? full : guard);
  }
  EXPECT_GT(full, 0);
  EXPECT_GT(guard, 0);
}

TEST(ContactSearch, CandidatesHoldEveryPairOfATurningBody) {
  test::Surface s;
  add_table(s, 4e-3);
  const VertexOwner body{0, 0};
  add_tile(s, 0, 0, &body);
  s.blocks = 2;
  Scene scene(s);
  scene.bodies = {{Mat3::Identity(), Vec3(0.005, 0, 0.005)}};
  scene.direction = {Vec3(1e-4, 0, 0), Vec3(0, 0, 3.1)};  // about the z axis: the sides dip 5 mm, through the table
  ContactSearch search(scene.mesh(), 1.5e-3, 1.5e-3);
  search.update(scene.paths(), 0);
  expect_holds_all(keys(search.candidates()), near_pairs(scene, 2 * kXi, 1.5e-3));
  EXPECT_LT(search.limit_steps(scene.paths(), {})[1], 0.5);
}

TEST(ContactSearch, ConstantsOfAPairComeFromItsTwoPrimitives) {
  test::Surface s;
  test::add_object(s, {{0, 0, 0}, {1, 0, 0}, {0, 0, 1}}, {{0, 1, 2}}, 0.01, nullptr, 2);
  test::add_object(s, {{0.2, 0.05, 0.2}, {0.8, 0.05, 0.2}, {0.2, 0.05, 0.6}}, {{0, 1, 2}}, 0.02, nullptr, 1);
  s.mesh.materials = 3;
  s.mesh.kappa = {10, 11, 12, 11, 21, 22, 12, 22, 32};  // [Pa]
  s.mesh.vertices[3].xi = 0.015;
  Scene scene(s);
  ContactSearch search(scene.mesh(), 0.1, 0.1);
  search.update(scene.paths(), 0);
  int kinds[2] = {0, 0};
  for (const ContactPair& p : search.candidates()) {
    ++kinds[static_cast<int>(p.kind)];
    EXPECT_EQ(p.interface, p.v[0] < 3 ? 2 * 3 + 1 : 1 * 3 + 2) << "the material of the first primitive, then that of the second";
    EXPECT_EQ(p.kappa, 22);
    const bool small_vertex = p.v[0] >= 3;
    if (p.kind == PairKind::vertex_triangle) {
      EXPECT_DOUBLE_EQ(p.xi, small_vertex ? (p.v[0] == 3 ? 0.015 : 0.02) + 0.01 : 0.01 + 0.02);
      EXPECT_DOUBLE_EQ(p.weight, small_vertex ? 0.12 / 3 : 0.12);  // areas 0.5 and 0.12: vertex share 0.04, or 0.5 / 3 against 0.12
      EXPECT_EQ(p.mollifier, 0);
    } else {
      const auto length2 = [&](int a, int b) {
        return (s.x[static_cast<std::size_t>(a)] - s.x[static_cast<std::size_t>(b)]).squaredNorm();
      };
      EXPECT_DOUBLE_EQ(p.xi, 0.01 + 0.02);
      EXPECT_DOUBLE_EQ(p.weight, 0.12 / 3);
      EXPECT_DOUBLE_EQ(p.mollifier, 1e-3 * length2(p.v[0], p.v[1]) * length2(p.v[2], p.v[3]));
    }
  }
  EXPECT_GT(kinds[0], 0);
  EXPECT_GT(kinds[1], 0);
  EXPECT_EQ(kinds[0], search.report().vertex_triangle);
  EXPECT_EQ(kinds[1], search.report().edge_edge);
}

TEST(ContactSearch, CandidatesAreReusedExactlyWhileEveryPathStaysInItsTrustBox) {
  Scene scene(test::folded_strip(3, 10, 2.7e-4, kXi));
  scene.jiggle(1e-4, 7);
  ContactSearch search(scene.mesh(), kDhat, kDhat);
  EXPECT_TRUE(search.update(scene.paths(), 5e-5));
  EXPECT_FALSE(search.update(scene.paths(), 5e-5));
  scene.move(0.5);
  for (Vec3& d : scene.direction) d *= 0.5;
  EXPECT_FALSE(search.update(scene.paths(), 5e-5)) << "the rest of the same paths";
  const std::vector<Vec3> kept = scene.direction;
  scene.direction[17] += Vec3(2e-4, 0, 0);
  EXPECT_TRUE(search.update(scene.paths(), 5e-5)) << "one vertex leaves";
  expect_holds_all(keys(search.candidates()), near_pairs(scene, 2 * kXi, kDhat));
  EXPECT_EQ(search.report().rebuilds, 2);
  EXPECT_EQ(search.report().reuses, 2);
}

TEST(ContactSearch, AnArcThatOnlyBulgesOutOfItsBoxIsNotOverlooked) {
  test::Surface s;
  add_table(s, 1);
  const VertexOwner body{0, 0};
  add_tile(s, 0, 0, &body);
  s.blocks = 2;
  Scene scene(s);
  scene.bodies = {{Mat3::Identity(), Vec3(0.005, 0, 0.005)}};
  scene.direction = {Vec3::Zero(), Vec3::Zero()};
  ContactSearch search(scene.mesh(), kDhat, kDhat);
  search.update(scene.paths(), 1e-4);
  scene.direction = {Vec3::Zero(), Vec3(0, 2 * 3.14159265358979323846, 0)};  // a full turn ends where it began
  EXPECT_TRUE(search.update(scene.paths(), 1e-4));
}

TEST(ContactSearch, NoMotionLeavesNoPairBetweenFixedThingsOrWithinOneBody) {
  test::Surface s;
  add_table(s, 0);
  add_table(s, 1e-4);
  const VertexOwner body{0, 0};
  add_tile(s, 0.5, 0.5, &body);
  add_tile(s, 0.5, 0.5001, &body);
  s.blocks = 2;
  Scene scene(s);
  scene.bodies = {{Mat3::Identity(), Vec3(0.5, 0.5, 0)}};
  ContactSearch search(scene.mesh(), kDhat, kDhat);
  search.update(scene.paths(), 1e-3);
  EXPECT_EQ(search.candidates().size, 0);
}

TEST(ContactSearch, SaysWhetherPathsMeetMorePairsThanAskedForAndMakesThemAllTheSame) {
  Scene scene(test::wound_strip(8, 2.7e-4, kXi));
  ContactSearch search(scene.mesh(), kDhat, kDhat / 2);
  const int primitives = static_cast<int>(scene.mesh().vertices.size() + scene.mesh().edges.size());
  scene.jiggle(5e-3, 3);
  search.update(scene.paths(), 0);
  const std::set<Key> found = keys(search.candidates());
  const int each = search.candidates().size / primitives;
  EXPECT_GT(each, 20);
  EXPECT_FALSE(search.within(scene.paths(), 0, each));
  EXPECT_TRUE(search.within(scene.paths(), 0, each + 1));
  EXPECT_TRUE(search.update(scene.paths(), 0)) << "it has forgotten what it knew";
  EXPECT_EQ(keys(search.candidates()), found);
}

TEST(ContactSearch, OnlyWhatCandidatesConnectSharesAStepLimit) {
  test::Surface s;
  add_table(s, 1e-3);      // 0: fixed, under everything
  add_tile(s, 0, 0);       // 1: falls onto the table
  add_tile(s, 0, 1.8e-3);  // 2: lies close above 1, at rest
  add_tile(s, 0.1, 0);     // 3: far away, glides along the table
  add_tile(s, 0.2, 0);     // 4: falls half as far as 1
  Scene scene(s);
  const auto set = [&](int tile, const Vec3& d) { std::fill_n(scene.direction.begin() + 4 * (tile - 1), 4, d); };
  set(1, Vec3(0, -2e-3, 0)), set(3, Vec3(1e-3, 0, 0)), set(4, Vec3(0, -1e-3, 0));
  ContactSearch search(scene.mesh(), 1.9e-3, 1.9e-3);
  search.update(scene.paths(), 0);
  const Real eta = 0.2, gap = 1e-3 - 2 * kXi;
  const std::vector<Real> limit = search.limit_steps(scene.paths(), {.eta = eta});
  ASSERT_EQ(limit.size(), 5u);
  EXPECT_EQ(limit[0], 1);
  EXPECT_NEAR(limit[1], (1 - eta) * gap / 2e-3, 0.02 * limit[1]);  // head-on: stops when eta of the gap is left
  EXPECT_EQ(limit[2], limit[1]) << "joined through their candidates";
  EXPECT_EQ(limit[3], 1) << "the table connects nothing";
  EXPECT_NEAR(limit[4], (1 - eta) * gap / 1e-3, 0.02 * limit[4]);
  EXPECT_EQ(search.report().capped, 0);
  Buffer<Vec3> scaled(scene.direction);
  search.scale(scaled.span());
  for (int b = 0; b < 16; ++b)
    EXPECT_EQ(scaled.span()[b], Vec3(limit[static_cast<std::size_t>(1 + b / 4)] * scene.direction[static_cast<std::size_t>(b)]));
}

TEST(ContactSearch, WhatIsTiedSharesAStepLimitAndNothingElseDoes) {
  for (const bool tied : {true, false}) {
    test::Surface s;
    add_table(s, 1e-3);
    add_tile(s, 0, 0);
    add_tile(s, 0.5, 0.5);
    if (tied) s.mesh.tied = {{0, 2}, {1, 2}};  // the table is fixed: it ties nothing
    Scene scene(s);
    std::fill_n(scene.direction.begin(), 4, Vec3(0, -2e-3, 0));
    ContactSearch search(scene.mesh(), kDhat, kDhat);
    search.update(scene.paths(), 0);
    const std::vector<Real> limit = search.limit_steps(scene.paths(), {});
    EXPECT_LT(limit[1], 0.5);
    EXPECT_EQ(limit[2], tied ? limit[1] : 1);
  }
}

TEST(ContactSearch, TwoObjectsOnOneBodyShareAStepLimit) {
  test::Surface s;
  add_table(s, 1e-3);
  const VertexOwner body{0, 0};
  add_tile(s, 0, 0, &body);
  add_tile(s, 0.5, 0.5, &body);
  s.blocks = 2;
  Scene scene(s);
  scene.bodies = {{Mat3::Identity(), Vec3(0, 0, 0)}};
  scene.direction = {Vec3(0, -2e-3, 0), Vec3::Zero()};
  ContactSearch search(scene.mesh(), kDhat, kDhat);
  search.update(scene.paths(), 0);
  const std::vector<Real> limit = search.limit_steps(scene.paths(), {});
  EXPECT_LT(limit[1], 0.5);
  EXPECT_EQ(limit[2], limit[1]);
}

TEST(ContactSearch, WhatRidesABodySharesItsStepLimit) {
  for (const bool rides : {true, false}) {
    test::Surface s;
    add_table(s, 1e-3);
    const VertexOwner body{0, 0};
    add_tile(s, 0, 0, &body);
    s.blocks = 2;
    add_tile(s, 0.5, 0.5);
    for (std::size_t v = s.x.size() - 4; rides && v < s.x.size(); ++v) s.mesh.owner[v].ride = 0, s.mesh.owner[v].ride_block = 0;
    Scene scene(s);
    scene.bodies = {{Mat3::Identity(), Vec3(0, 0, 0)}};
    scene.direction[0] = Vec3(0, -2e-3, 0);
    ContactSearch search(scene.mesh(), kDhat, kDhat);
    search.update(scene.paths(), 0);
    const std::vector<Real> limit = search.limit_steps(scene.paths(), {});
    EXPECT_LT(limit[1], 0.5);
    EXPECT_EQ(limit[2], rides ? limit[1] : 1) << "a rider's path follows from both directions";
  }
}

TEST(ContactSearch, ThreadsAndOrderOfIterationsChangeNothing) {
  Scene scene(test::wound_strip(6, 2.7e-4, kXi));
  scene.jiggle(2e-4, 11);
  const auto run = [&](int n, std::uint64_t seed) {
    set_threads(n), set_shuffled_order(seed);
    ContactSearch search(scene.mesh(), kDhat, kDhat);
    search.update(scene.paths(), 1e-5);
    std::vector<Key> order;
    for (const ContactPair& p : search.candidates()) order.push_back(key(p));
    const std::vector<Real> limit = search.limit_steps(scene.paths(), {});
    set_threads(0), set_shuffled_order(0);
    return std::pair(order, limit);
  };
  const auto one = run(1, 0);
  EXPECT_LT(one.second[0], 1);
  EXPECT_TRUE(std::ranges::is_sorted(one.first, {}, [](const Key& k) { return std::pair(std::get<0>(k), std::get<1>(k)); }));
  EXPECT_EQ(run(2, 0), one);
  EXPECT_EQ(run(8, 0), one);
  EXPECT_EQ(run(1, 42), one);
}

TEST(ContactSearch, AnEmptySurfaceHasNoCandidates) {
  Scene scene{test::Surface{}};
  ContactSearch search(scene.mesh(), kDhat, kDhat);
  search.update(scene.paths(), 0);
  EXPECT_EQ(search.candidates().size, 0);
  EXPECT_TRUE(search.limit_steps(scene.paths(), {}).empty());
}

TEST(ContactSearch, SamplesFindEveryTriangleInReach) {
  for (const test::Surface& surface : {test::wound_strip(1.3, 2.7e-4, kXi), test::scattered_triangles(60, 0.2, 0.01, 3)}) {
    const Real dhat = surface.mesh.vertices[0].xi == kXi ? kDhat : 0.02;
    Scene scene(surface);
    scene.jiggle(dhat, 5);
    ContactSearch search(scene.mesh(), dhat, dhat);
    search.update(scene.paths(), dhat / 4);
    scene.move(0.7);  // within the trust boxes
    const std::vector<Vec3>& x = scene.surface.x;
    const std::vector<SurfaceTriangle>& triangles = scene.mesh().triangles;
    const on_cpu::detail::SampleQuery query = search.samples(scene.paths());
    constexpr int kSide = 3;
    std::set<std::pair<int, int>> found, near;
    for (int sample = 0; sample < static_cast<int>(triangles.size()) * kSide * kSide; ++sample) {
      query.visit(sample, kSide, [&](const SamplePair& p, Real) { found.insert({p.id.sample, p.id.triangle}); });
      const SurfaceTriangle& own = triangles[static_cast<std::size_t>(sample / (kSide * kSide))];
      for (int t = 0; t < static_cast<int>(triangles.size()); ++t) {
        const SurfaceTriangle& other = triangles[static_cast<std::size_t>(t)];
        const Vec3 point = query.s.sample_triangle(sample, t, kSide).point(query.x);
        const Vec3 at[4] = {point, x[static_cast<std::size_t>(other.v[0])], x[static_cast<std::size_t>(other.v[1])],
                            x[static_cast<std::size_t>(other.v[2])]};
        const Real d = combine(closest_vertex_triangle(at).weight, at).norm();
        const bool apart = std::ranges::find_first_of(own.v, other.v) == std::end(own.v);
        if (apart && d < 2 * scene.mesh().vertices[0].xi + dhat) near.insert({sample, t});
      }
    }
    EXPECT_FALSE(near.empty());
    EXPECT_EQ(found, near);
  }
}

TEST(ContactSearch, SamplesOfATriangleAreTheCentroidsOfEqualPieces) {  // so that they integrate linear functions, and the area
  const test::Surface surface = test::wound_strip(0.1, 2.7e-4, kXi);
  const on_cpu::detail::SurfaceBuffers buffers(surface.mesh, kDhat, kDhat);
  for (int n : {1, 2, 3, 5}) {
    Real area = 0;
    Vec3 mean = Vec3::Zero();
    std::set<std::pair<long, long>> places;
    for (int k = 0; k < n * n; ++k) {
      const SamplePair p = buffers.view().sample_triangle(7 * n * n + k, 0, n);
      area += p.area;
      mean += Vec3(p.w[0], p.w[1], p.w[2]) / (n * n);
      for (Real w : p.w) EXPECT_GT(w, 0);
      places.insert({std::lround(3 * n * p.w[0]), std::lround(3 * n * p.w[1])});
    }
    EXPECT_NEAR(area, surface.mesh.triangles[7].area, 1e-15);
    EXPECT_LT((mean - Vec3::Constant(1.0 / 3)).norm(), 1e-15);
    EXPECT_EQ(places.size(), static_cast<std::size_t>(n * n)) << "no two are the same";
  }
}
