#include "tape/step/cut.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <numbers>

#include "tape/contact/intersection.hpp"
#include "tape/math/rotation.hpp"
#include "tape/model/primitives.hpp"
#include "tape/model/sharp_edge.hpp"
#include "tests/support/simulation.hpp"
using namespace tape;

namespace {
constexpr Real kLength = 0.1, kWidth = 0.019;  // [m]

/// A blade across the strip's middle, its edge `height` [m] above it, that moves with `velocity`.
void add_blade(Setup& setup, Real x, Real height, const Vec3& velocity = Vec3::Zero()) {
  Body& blade = test::add_body(setup, "blade", wedge_mesh(Vec3(0.0005, 0.03, 0.01)), velocity.isZero() ? Motion::fixed : Motion::driven,
                               Vec3::Zero());
  const std::vector<Vec3> edge = sharp_edge(blade.mesh, std::numbers::pi / 4);
  ASSERT_EQ(edge.size(), 2u);
  const Vec3 up(0, 0, edge[0].z());  // the edge points down
  blade.pose.rotation = rotation_exp(Vec3(0, edge[0].z() > 0 ? std::numbers::pi : 0, 0));
  blade.pose.position = Vec3(x, 0, height) - blade.pose.rotation * up;
  blade.velocity = velocity;
  setup.scene.blades = {{"blade", edge}};
}
Setup strip_under_blade(Real height, const Vec3& velocity = Vec3::Zero()) {
  tape::Setup setup = test::strip_setup(test::flat_strip(kLength, 4, Vec3::Zero()));
  setup.scene.gravity.setZero();
  add_blade(setup, 0.052, height, velocity);
  setup.cutting.trigger.steps = 1;
  return setup;
}
/// As if the blade pressed on the triangle at a rest place of the first strip.
std::vector<BladePressure> pressed(const World& world, const Vec2& place) {
  const StripPart& strip = world.assembly.strips[0];
  Real best = 1e300;
  BladePressure out{.peak = 1e9, .triangle = -1, .above = {}};
  for (int t = strip.first_triangle; t < strip.first_triangle + strip.triangles; ++t) {
    Vec2 centre = Vec2::Zero();
    for (int v : world.assembly.triangles[static_cast<std::size_t>(t)]) centre += world.assembly.rest[static_cast<std::size_t>(v)] / 3;
    if ((centre - place).norm() < best) best = (centre - place).norm(), out.triangle = t;
  }
  return {out};
}
struct Moments {
  Real mass = 0;
  Vec3 linear = Vec3::Zero(), angular = Vec3::Zero();
};
Moments moments(const test::Simulation& s) {
  Moments m;
  for (std::size_t v = 0; v < s.state().x.size(); ++v) {
    const Real mass = s.world().assembly.mass[v];
    m.mass += mass, m.linear += mass * s.state().v[v], m.angular += mass * s.state().x[v].cross(s.state().v[v]);
  }
  return m;
}
std::string snapshot_name(const std::string& what) {
  return (std::filesystem::temp_directory_path() / ("tape_cut_" + what + std::to_string(getpid()) + ".h5")).string();
}
}  // namespace

TEST(Cut, ABladeThatPressesSeparatesATautStripAndItsTensionGoes) {
  for (bool cuts : {true, false}) {
    tape::Setup setup = strip_under_blade(1.5e-3, Vec3(0, 0, -0.01));
    const StripMesh mesh = make_strip_mesh(setup.scene.strips[0].mesh, kWidth, 1);
    Grip pull = test::hold("pull", tip_vertices(mesh, 1e-6));
    pull.motion = {{0.0, 0.1, Vec3(5e-4, 0, 0)}};
    setup.scene.grips = {test::hold("hold", root_vertices(mesh, 1e-6)), pull};
    if (!cuts) setup.scene.blades.clear();
    test::Simulation s(setup);
    int made = 0;
    Real taut = 0;
    s.run_to(0.5, [&](const test::Simulation& now) {
      if (made == 0) taut = std::max(taut, now.report().grip_force[0].norm());
      for (const CutReport& cut : now.cuts()) made += cut.refusal.empty();
    });
    EXPECT_TRUE(s.broken.empty()) << s.broken.front();
    const Real tension = 5e7 * 1.8e-4 * kWidth * 5e-4 / kLength;  // E A strain, without what narrowing gives: 0.855 N
    if (cuts) {
      EXPECT_NEAR(taut, tension, 0.3 * tension) << "the blade bends the strip until it cuts";
    }
    EXPECT_EQ(made, cuts ? 1 : 0);
    if (cuts)
      EXPECT_LT(s.report().grip_force[0].norm(), 0.01 * tension);
    else
      EXPECT_GT(s.report().grip_force[0].norm(), tension);
  }
}
TEST(Cut, AreaMassAndMomentumOfWhatIsLeftAndOfTheKerfAreThoseOfBefore) {
  test::Simulation s(strip_under_blade(2e-3));
  for (std::size_t v = 0; v < s.state().v.size(); ++v) {
    const Vec3 x = s.state().x[v];
    s.state().v[v] = Vec3(0.1, 0, 0) + Vec3(3, 5, 2).cross(x) + Vec3(0, 0, std::sin(200 * x.x()) * std::cos(300 * x.y()));
  }
  const Moments before = moments(s);
  s.cut(pressed(s.world(), {0.052, 0}));
  ASSERT_EQ(s.cuts().size(), 1u);
  const CutReport& cut = s.cuts()[0];
  ASSERT_EQ(cut.refusal, "");
  EXPECT_EQ(cut.pieces, 2);
  const Moments after = moments(s);
  EXPECT_NEAR(after.mass + cut.kerf_mass, before.mass, 1e-12 * before.mass);
  EXPECT_NEAR(cut.kerf_area, 1.5e-3 * kWidth, 1e-9 * kWidth);
  EXPECT_NEAR(cut.kerf_mass, cut.kerf_area * 1.8e-4 * 1300, 1e-15);
  const Vec3 gone = before.linear - after.linear;
  EXPECT_NEAR(gone.x(), cut.kerf_mass * 0.1, 0.05 * cut.kerf_mass) << "the kerf took along what it had: 0.1 m/s and its turning";
  EXPECT_GT(cut.smallest_angle, 15);
  EXPECT_EQ(find_intersections(s.world().surface, s.x()).count, 0);
  s.step();
  EXPECT_TRUE(s.broken.empty()) << s.broken.front();
}
TEST(Cut, ARefusedOneLeavesWorldAndStateAsTheyAre) {
  test::Simulation s(strip_under_blade(0.05));  // out of the blade's reach
  const std::string before = s.state().hash();
  s.cut(pressed(s.world(), {0.052, 0}));
  ASSERT_EQ(s.cuts().size(), 1u);
  EXPECT_NE(s.cuts()[0].refusal, "");
  State same = s.state();
  same.triggers[0] = {};
  EXPECT_EQ(same.hash(), before) << "but for the cooldown";
  EXPECT_EQ(s.world().assembly.strip_vertices, std::ssize(s.state().x));
}
TEST(Cut, IsFollowedByACooldownAndWhereRefusedByAnotherTry) {
  for (const auto& [height, waiting] : {std::pair{2e-3, 7}, {0.05, 2}}) {  // the second is out of the blade's reach
    tape::Setup setup = strip_under_blade(height);
    setup.cutting.trigger.cooldown = 7, setup.cutting.trigger.retry = 2;
    test::Simulation s(setup);
    s.cut(pressed(s.world(), {0.052, 0}));
    ASSERT_EQ(s.cuts().size(), 1u);
    EXPECT_EQ(s.state().triggers[0].waiting, waiting) << s.cuts()[0].refusal;
  }
}
TEST(Cut, TapeThatSticksGoesOnSticking) {
  constexpr bool kStickyFace[2][2] = {{false, false}, {true, true}};
  for (AdhesionLaw law : {AdhesionLaw::per_pair, AdhesionLaw::per_area, AdhesionLaw::bond}) {
    tape::Setup setup = strip_under_blade(2e-3);
    setup.scene.gravity = Vec3(0, 0, 9.81);  // it hangs by its sticky face, upside down
    const Film film = test::vinyl();
    test::add_body(setup, "table", box_mesh(Vec3(0.14, 0.04, 0.01), {28, 8, 1}), Motion::fixed,
                   Vec3(0.05, 0, -0.005 - film.xi - 0.6 * film.dhat))
        .material = 1;
    setup.scene.materials.push_back({"table", 0.5});
    Adhesion adhesion{law, {}, {.cn = 0.675, .ct = 0.675, .beta0 = 1}, {.reach = 1}, {}};
    std::copy(&kStickyFace[0][0], &kStickyFace[0][0] + 4, &adhesion.sticks[0][0]);
    setup.scene.adhesives = {{0, 1, adhesion}};
    test::Simulation s(setup);
    s.run_to(0.1);
    const int live = s.report().adhesion[0].live;
    const Real normal = s.report().adhesion[0].normal;
    const std::vector<Vec3> before = s.state().x;
    s.cut(pressed(s.world(), {0.052, 0}));
    ASSERT_EQ(s.cuts()[0].refusal, "") << to_text(law);
    const std::vector<Vec3> cut = s.state().x;
    s.step();
    EXPECT_TRUE(s.broken.empty()) << to_text(law) << s.broken.front();
    // A cell and a half of 21 are gone, and new cells are as long as old ones.
    EXPECT_GT(s.report().adhesion[0].live, 0.85 * live) << to_text(law);
    EXPECT_NEAR(s.report().adhesion[0].normal, normal, 0.15 * normal) << to_text(law);
    Real moved = 0;
    for (std::size_t v = 0; v < cut.size(); ++v) moved = std::max(moved, (s.state().x[v] - cut[v]).norm());
    EXPECT_LT(moved, 0.1 * film.dhat) << to_text(law) << ": nothing springs at the cut";
    s.run_to(0.3);
    EXPECT_TRUE(s.broken.empty()) << to_text(law) << s.broken.front();
    for (const Vec3& x : s.state().x) EXPECT_LT(x.z(), 1e-4) << to_text(law);
  }
}
TEST(Cut, SavedBeforeOrAfterItGoesOnToTheBit) {
  tape::Setup setup = strip_under_blade(1e-3, Vec3(0, 0, -0.01));
  const StripMesh mesh = make_strip_mesh(setup.scene.strips[0].mesh, kWidth, 1);
  setup.scene.grips = {test::hold("left", root_vertices(mesh, 1e-6)), test::hold("right", tip_vertices(mesh, 1e-6))};
  const std::string early = snapshot_name("early"), late = snapshot_name("late");
  test::Simulation through(setup);
  bool cut = false;
  const int whole = through.world().assembly.strip_vertices;
  save_snapshot(early, through.world(), through.state());
  while (!cut) {
    through.step();
    ASSERT_LT(through.state().step, 100);
    cut = !through.cuts().empty() && through.cuts()[0].refusal.empty();
  }
  const int at = through.state().step;
  for (int k = 0; k < 2; ++k) through.step();
  save_snapshot(late, through.world(), through.state());
  const std::string hash = through.state().hash();
  for (int k = 0; k < 3; ++k) through.step();

  test::Simulation again(setup);
  again.resume(late);
  EXPECT_EQ(again.state().hash(), hash);
  for (int k = 0; k < 3; ++k) again.step();
  EXPECT_EQ(again.state().hash(), through.state().hash()) << "resumed after the cut";
  again.resume(early);
  EXPECT_EQ(again.world().assembly.strip_vertices, whole) << "whole again";
  while (again.state().step < at + 5) again.step();
  EXPECT_EQ(again.state().hash(), through.state().hash()) << "set back to before the cut";
  std::filesystem::remove(early), std::filesystem::remove(late);
}
TEST(Cut, PiecesCanBeCutAgainAndGripsKeepWhatIsLeft) {
  tape::Setup setup = strip_under_blade(2e-3);
  const StripMesh mesh = make_strip_mesh(setup.scene.strips[0].mesh, kWidth, 1);
  setup.scene.grips = {test::hold("root", root_vertices(mesh, 1e-6)), test::hold("band", vertices_between(mesh, 0.045, 0.06))};
  setup.cutting.trigger.cooldown = 0;
  Body& blade = test::add_body(setup, "second", setup.scene.bodies[0].mesh, Motion::fixed, Vec3::Zero());
  blade.pose = setup.scene.bodies[0].pose;
  blade.pose.position.x() = 0.02;
  setup.scene.blades.push_back({"second", setup.scene.blades[0].edge});
  test::Simulation s(setup);
  s.step();
  const std::size_t held = s.state().grip_base.size();
  s.cut({pressed(s.world(), {0.052, 0})[0], {}});
  ASSERT_EQ(s.cuts()[0].refusal, "");
  EXPECT_LT(s.state().grip_base.size(), held);
  EXPECT_GT(s.state().grip_base.size(), 5u + 2u);
  s.cut({{}, pressed(s.world(), {0.02, 0})[0]});
  ASSERT_EQ(s.cuts()[0].refusal, "");
  EXPECT_EQ(s.cuts()[0].pieces, 3);
  for (int k = 0; k < 3; ++k) s.step();
  EXPECT_TRUE(s.broken.empty()) << s.broken.front();
}
TEST(Cut, ASecondBladeWaitsAStep) {
  tape::Setup setup = strip_under_blade(2e-3);
  Body& blade = test::add_body(setup, "second", setup.scene.bodies[0].mesh, Motion::fixed, Vec3::Zero());
  blade.pose = setup.scene.bodies[0].pose;
  blade.pose.position.x() = 0.02;
  setup.scene.blades.push_back({"second", setup.scene.blades[0].edge});
  test::Simulation s(setup);
  s.cut({pressed(s.world(), {0.052, 0})[0], pressed(s.world(), {0.02, 0})[0]});
  ASSERT_EQ(s.cuts().size(), 1u);
  EXPECT_EQ(s.cuts()[0].blade, "blade");
  s.cut({{}, pressed(s.world(), {0.02, 0})[0]});
  ASSERT_EQ(s.cuts().size(), 1u);
  EXPECT_EQ(s.cuts()[0].blade, "second");
  EXPECT_EQ(s.cuts()[0].pieces, 3);
}
TEST(Cut, AKerfThatWouldCloseIsRefused) {
  tape::Setup setup = strip_under_blade(2e-3);
  setup.cutting.kerf.width = 2 * test::vinyl().xi + setup.scene.dhat();  // 0.27 mm
  EXPECT_THROW(World::build(setup), InputError);
  setup.cutting.kerf.width *= 1.04;
  EXPECT_THROW(World::build(setup), InputError) << "what a cut asks of the clearance";
  setup.cutting.kerf.width *= 1.02;
  EXPECT_NO_THROW(World::build(setup));
  setup.cutting.kerf.clearance = 2e-3;
  EXPECT_THROW(World::build(setup), InputError);
}
