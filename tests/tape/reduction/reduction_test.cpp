#include <gtest/gtest.h>

#include <algorithm>
#include <numbers>
#include <numeric>

#include "tape/math/rotation.hpp"
#include "tape/model/strip_mesh.hpp"
#include "tape/reduction/carriage.hpp"
#include "tape/reduction/front.hpp"
#include "tests/support/simulation.hpp"
using namespace tape;

namespace {
constexpr int kColumns = 3, kRows = 12, kCollar = 4;

/// A flat strip of 12 rows of three vertices that starts as if it were wound, and the body that its cluster is.
struct Reduced {
  Scene scene;
  Assembly assembly;
  Cluster cluster;
  explicit Reduced(MeshPattern pattern = MeshPattern::same) {
    Strip strip = test::flat_strip((kRows - 1) * 0.0095, kColumns - 1, Vec3(0.1, 0.2, 0.3));
    strip.mesh.pattern = pattern;
    scene = test::strip_setup(strip).scene;
    assembly = assemble(scene);
    BodyPart body;
    body.motion = Motion::dynamic, body.cluster_of = 0, body.block = assembly.blocks, body.centre = static_cast<int>(assembly.x.size());
    assembly.blocks += 2;
    assembly.bodies.push_back(body);
    assembly.x.push_back(Vec3::Zero()), assembly.local.push_back(Vec3::Zero()), assembly.mass.push_back(0);
    assembly.owner.push_back({body.block, 0});
  }
  const StripPart& part() const { return assembly.strips[0]; }
  StripGraph graph() const { return {assembly, part()}; }
  /// Adheres up to this row.
  void form(int row) {
    EffectMemory memory;
    for (int v = 0; v < kColumns * (row + 1); ++v) {
      Cohesion::Memory m;
      m.vertex = v, m.triangle = 0, m.beta = 1, m.slip.setZero();
      std::get<MemoryOf<Cohesion>>(memory).pairs.push_back(m);
    }
    cluster = form_cluster(assembly, part(), graph(), memory, assembly.x, 1, kCollar);
    weigh(assembly, part(), is_member(), cluster);
  }
  std::vector<bool> is_member() const { return members(assembly, part(), cluster, kCollar); }
  std::vector<int> carriers() const {
    std::vector<int> out;
    for (const VertexOwner& owner : carriage().owner) out.push_back(owner.body);
    return out;
  }
  Carriage carriage() const { return carry(assembly, {cluster}, nullptr, kCollar); }
};
int count(const std::vector<bool>& flags) { return static_cast<int>(std::ranges::count(flags, true)); }
}  // namespace

TEST(StripGraph, DistancesCountEdges) {
  for (MeshPattern pattern : {MeshPattern::same, MeshPattern::alternating, MeshPattern::crossed, MeshPattern::irregular}) {
    const Reduced r(pattern);
    const StripGraph graph = r.graph();
    std::vector<int> expected(static_cast<std::size_t>(graph.vertices()), 100);  // by relaxation until nothing changes
    expected[0] = expected[5] = 0;
    for (bool changed = true; changed;) {
      changed = false;
      for (int k = 0; k < r.part().triangles; ++k)
        for (int a : r.assembly.triangles[static_cast<std::size_t>(k)])
          for (int b : r.assembly.triangles[static_cast<std::size_t>(k)])
            if (const int beyond = expected[static_cast<std::size_t>(a)] + 1; beyond < expected[static_cast<std::size_t>(b)])
              expected[static_cast<std::size_t>(b)] = beyond, changed = true;
    }
    std::vector<int> distance(expected.size(), 100);
    graph.spread({0}, distance);
    graph.spread({5}, distance);
    EXPECT_EQ(distance, expected);
  }
}

TEST(Cluster, IsWhatAdheresWithoutACollar) {
  Reduced r;
  r.form(8);
  for (int row = 0; row < kRows; ++row)
    for (int c = 0; c < kColumns; ++c)
      EXPECT_EQ((*r.cluster.distance)[static_cast<std::size_t>(kColumns * row + c)], std::clamp(9 - row, 0, kCollar)) << row;
  const std::vector<bool> member = r.is_member();
  EXPECT_EQ(count(member), kColumns * 6);
  EXPECT_TRUE(member[kColumns * 6 - 1]);
}
TEST(Cluster, OfASingleRowOrOfWhatDoesNotAdhereHasNoMembers) {
  for (int row : {3, 0, -1}) {  // rows 0, none, none are far enough from the free tape
    Reduced r;
    r.form(row);
    EXPECT_EQ(count(r.is_member()), 0) << row;
    EXPECT_EQ(r.cluster.mass.mass, 1) << "a body that nothing touches";
  }
}
TEST(Cluster, NeverHoldsTheEndOfTheStrip) {
  Reduced r;
  r.form(kRows - 1);
  for (int c = 0; c < kColumns; ++c) EXPECT_EQ((*r.cluster.distance)[static_cast<std::size_t>(kColumns * (kRows - 1) + c)], 0);
}
TEST(Cluster, HasTheMassOfItsMembers) {
  Reduced r;
  r.form(8);
  Real mass = 0;
  Vec3 first = Vec3::Zero();
  for (int v = 0; v < kColumns * 6; ++v) {
    mass += r.assembly.mass[static_cast<std::size_t>(v)];
    first += r.assembly.mass[static_cast<std::size_t>(v)] * r.assembly.x[static_cast<std::size_t>(v)];
  }
  EXPECT_NEAR(r.cluster.mass.mass, mass, 1e-15 * mass);
  EXPECT_LT((r.cluster.centre - first / mass).norm(), 1e-15);
  // About its centre, along x: sum m (x - c)^2, by the parallel axis theorem.
  Real second = -mass * r.cluster.centre.x() * r.cluster.centre.x();
  for (int v = 0; v < kColumns * 6; ++v)
    second += r.assembly.mass[static_cast<std::size_t>(v)] * std::pow(r.assembly.x[static_cast<std::size_t>(v)].x(), 2);
  EXPECT_NEAR(r.cluster.mass.second(0, 0), second, 1e-12 * second);
}
TEST(Cluster, PairsBetweenMembersSleep) {
  Reduced r;
  r.form(8);
  EffectMemory awake, asleep;
  std::vector<Cohesion::Memory>& pairs = std::get<MemoryOf<Cohesion>>(awake).pairs;
  const int last = r.part().triangles - 1;
  for (const auto& [vertex, triangle] : {std::pair{0, last}, {0, 0}, {kColumns * 6, 0}, {kColumns * 6 - 1, 1}, {kColumns * 6 - 1, last}}) {
    Cohesion::Memory m;
    m.vertex = vertex, m.triangle = triangle, m.beta = 0.1 * vertex, m.slip.setZero();
    pairs.push_back(m);
  }
  sort_pairs(r.assembly, r.carriers(), 1, awake, asleep);
  const std::vector<Cohesion::Memory>& down = std::get<MemoryOf<Cohesion>>(asleep).pairs;
  ASSERT_EQ(down.size(), 2u);
  EXPECT_EQ(down[0].vertex, 0);
  EXPECT_EQ(down[1].vertex, kColumns * 6 - 1);
  EXPECT_EQ(down[1].beta, 0.1 * (kColumns * 6 - 1));
  EXPECT_EQ(pairs.size(), 3u);
  r.cluster.distance = std::make_shared<const std::vector<int>>(static_cast<std::size_t>(r.part().vertices), 0);  // all of it is free
  sort_pairs(r.assembly, r.carriers(), 1, awake, asleep);
  EXPECT_TRUE(down.empty());
  EXPECT_EQ(pairs.size(), 5u);
  EXPECT_TRUE(std::ranges::is_sorted(pairs, {}, [](const auto& p) { return p.key(); }));
}

TEST(Carriage, CarriesEveryVertexAndAllMassOnce) {
  Reduced r;
  for (int row : {-1, 5, 8, kRows - 1}) {
    r.form(row);
    const Carriage c = r.carriage();
    const std::vector<bool> member = r.is_member();
    std::vector<int> blocks;
    for (int v = 0; v < r.part().vertices; ++v) {
      const VertexOwner o = c.owner[static_cast<std::size_t>(v)];
      EXPECT_EQ(o.body, member[static_cast<std::size_t>(v)] ? 0 : -1);
      if (o.body < 0) blocks.push_back(o.block);
      if (o.body == 0) {
        EXPECT_LT((c.local[static_cast<std::size_t>(v)] + r.cluster.centre - r.assembly.x[static_cast<std::size_t>(v)]).norm(), 1e-16);
      }
    }
    std::vector<int> consecutive(blocks.size());
    std::iota(consecutive.begin(), consecutive.end(), c.strips[0].block);
    EXPECT_EQ(blocks, consecutive);
    EXPECT_EQ(c.strips[0].blocks, std::ssize(blocks));
    EXPECT_EQ(c.blocks, c.strips[0].block + c.strips[0].blocks);
    const Real all = std::accumulate(r.assembly.mass.begin(), r.assembly.mass.end(), 0.0);
    EXPECT_NEAR(std::accumulate(c.mass.begin(), c.mass.end(), 0.0), all, 1e-15 * all);
  }
}

namespace {
/// The front where vertex v has moved from where the cluster carries it.
std::vector<int> front(const Reduced& r, int v, const Vec3& moved, Gate gate, const std::vector<Bonds::Memory>* bonds = nullptr) {
  const Pose pose{rotation_exp(Vec3(0.3, -0.2, 1)), Vec3(0.5, 0, 0.1)};
  std::vector<Vec3> x;
  for (const Vec3& y : *r.cluster.local) x.push_back(apply(pose, y - r.cluster.centre));
  x[static_cast<std::size_t>(v)] += moved;
  const Pose hub{rotation_exp(Vec3(std::numbers::pi / 2, 0, 0)),
                 x[static_cast<std::size_t>(v)] - moved - Vec3(0, 0, 0.02)};  // its axis is y
  return pass_front({r.assembly, r.part(), r.assembly.bodies[0], x, pose, hub}, r.cluster, r.carriage().next[0], gate, 9e-4, bonds);
}
constexpr int kNext = kColumns * 8 + 1, kSecond = kColumns * 7 + 1;  // one and two edges from the free tape
}  // namespace

TEST(Front, OpensWhereTapeLeavesItsPlace) {
  Reduced r;
  r.form(8);
  const Vec3 off(0, 0, 1e-3), around(1e-3, 0, 0);
  EXPECT_EQ(front(r, kNext, off, Gate::euclidean), std::vector{kNext});
  EXPECT_EQ(front(r, kNext, off, Gate::radial), std::vector{kNext});
  EXPECT_EQ(front(r, kNext, 0.8 * off, Gate::euclidean), std::vector<int>());
  EXPECT_EQ(front(r, kNext, around, Gate::euclidean), std::vector{kNext});
  EXPECT_EQ(front(r, kNext, around, Gate::radial), std::vector<int>());
  EXPECT_EQ(front(r, kSecond, off, Gate::euclidean), std::vector<int>()) << "its neighbours are not free yet";
}
TEST(Front, BondsOpenItOnlyWhereTheyGaveWayAndNoneHolds) {
  Reduced r;
  r.form(8);
  const auto bond = [&](int vertex, int triangle, int cooldown) {
    Bonds::Memory m;
    m.vertex = vertex, m.triangle = triangle, m.cooldown = cooldown, m.rest = 1e-4, m.inverse.setIdentity();
    return m;
  };
  const Vec3 off(0, 0, 1e-3);
  const std::vector<Bonds::Memory> two = {bond(kNext, 0, 0), bond(kNext, 1, 0)}, one = {two[1]}, none = {};
  const auto passes = [&](const std::vector<Bonds::Memory>& now) { return !front(r, kNext, off, Gate::euclidean, &now).empty(); };
  const std::vector<Vec3> x(r.assembly.x.size(), Vec3::Zero());
  const FrontView view{r.assembly, r.part(), r.assembly.bodies[0], x, {}, {}};
  EXPECT_FALSE(passes(none)) << "no bond has let it go";
  mark_released(view, two, one, r.cluster);
  EXPECT_FALSE(passes(one)) << "one still holds it";
  EXPECT_TRUE(passes(none));
  EXPECT_TRUE(passes({bond(kNext, 1, 3)})) << "one that was released holds nothing";
  // Free tape that lies on the roll again holds it, but not in its place.
  EXPECT_TRUE(passes({bond(kNext, r.part().triangles - 1, 0)}));
  // What it sticks to beside the roll neither holds it there nor lets it go.
  r.assembly.triangles.emplace_back(100, 101, 102);
  const Bonds::Memory aside = bond(kNext, static_cast<int>(r.assembly.triangles.size()) - 1, 0);
  EXPECT_TRUE(passes({aside}));
  r.cluster.released.clear();
  mark_released(view, {aside}, none, r.cluster);
  EXPECT_FALSE(passes(none));
}
