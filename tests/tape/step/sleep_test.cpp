#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <numbers>

#include "tape/model/primitives.hpp"
#include "tape/model/strip_mesh.hpp"
#include "tape/step/reduce.hpp"
#include "tape/step/sleep.hpp"
#include "tests/support/simulation.hpp"
using namespace tape;

namespace {
constexpr Real kGap = 0.79;    // [dhat] between faces where the tests' cohesion rests
constexpr Real kAfter = 0.05;  // [s]

/// A strip of vinyl that lies on plates by its sticky face, without gravity.
struct OnPlates {
  Setup setup;
  explicit OnPlates(Real length, AdhesionLaw law = AdhesionLaw::per_area) {
    Strip strip = test::flat_strip(length, 4, Vec3::Zero());
    setup = test::strip_setup(strip);
    Film& film = setup.scene.films[0];
    film.width = 0.012;
    setup.scene.strips[0].pose.position.z() = film.xi + kGap * film.dhat;
    setup.scene.gravity.setZero();
    setup.scene.contact.kappa = 1e3;
    setup.scene.sleep = {.after = kAfter, .move = 0.05, .edges = 3};
    setup.scene.materials.push_back({"plate", 0.5});
    setup.scene.adhesives = {{0,
                              1,
                              {law,
                               {{false, false}, {true, true}},
                               {.cn = 0.675, .ct = 0.675, .beta0 = 1},
                               {.strength = 5e3, .toughness = 1, .peak = 0.1, .shear = 1, .rest = 0.8, .reach = 0.8},
                               {}}}};
  }
  /// 10 mm thick, its upper face at z = 0, wide enough for the strip.
  Body& plate(const std::string& name, Real from, Real to, Motion motion) {
    const int cells = std::max(2, static_cast<int>((to - from) / 0.01));
    Body& body =
        test::add_body(setup, name, box_mesh(Vec3(to - from, 0.02, 0.01), {cells, 2, 1}), motion, Vec3((from + to) / 2, 0, -0.005));
    body.material = 1;
    return body;
  }
  std::vector<int> tip() const {
    return tip_vertices(make_strip_mesh(setup.scene.strips[0].mesh, setup.scene.films[0].width, setup.scene.seed), 1e-6);
  }
};
int asleep_on(const State& state, int body) {
  return state.sleepers ? static_cast<int>(std::ranges::count(state.sleepers->body, body)) : 0;
}
Real farthest(const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
  Real far = 0;
  for (std::size_t v = 0; v < a.size(); ++v) far = std::max(far, (a[v] - b[v]).norm());
  return far;
}
}  // namespace

TEST(Sleep, TapeThatLiesStillSleepsAndNothingIsLeftToSolve) {
  for (AdhesionLaw law : {AdhesionLaw::per_area, AdhesionLaw::per_pair, AdhesionLaw::bond}) {
    OnPlates scene(0.05, law);
    scene.plate("table", -0.01, 0.06, Motion::fixed);
    test::Simulation s(scene.setup);
    s.run_to(0.2);
    EXPECT_TRUE(s.broken.empty()) << s.broken.front();
    EXPECT_EQ(s.report().asleep, s.world().assembly.strip_vertices) << to_text(law);
    EXPECT_EQ(s.report().newton, 0);
    const std::vector<Vec3> x = s.state().x;
    s.run_to(0.3);
    EXPECT_EQ(farthest(x, s.state().x), 0);
    EXPECT_EQ(s.report().kinetic, 0);
  }
}
TEST(Sleep, TapeThatIsPeeledOffWakesAndIsPulledAsIfItHadNotSlept) {
  // The hand waits until all sleeps, then lifts the end by 6 mm.
  const auto peel = [](Real after) {
    OnPlates scene(0.1);
    scene.plate("table", -0.01, 0.11, Motion::fixed);
    scene.setup.scene.sleep.after = after;
    Grip hand = test::hold("hand", scene.tip());
    hand.start = 0.2;
    hand.motion = {{0.2, 0.4, Vec3(0, 0, 0.006)}};
    scene.setup.scene.grips = {hand};
    return test::Simulation(scene.setup);
  };
  test::Simulation sleeper = peel(kAfter), awake = peel(0);
  std::vector<Real> asleep;
  Real most = 0, apart = 0, force = 0;
  while (awake.state().time < 0.6 - 1e-9) {
    sleeper.step(), awake.step();
    asleep.push_back(sleeper.report().asleep);
    const Vec3 pull = awake.report().grip_force[0];
    most = std::max(most, farthest(sleeper.state().x, awake.state().x));
    force = std::max(force, pull.norm());
    apart = std::max(apart, (sleeper.report().grip_force[0] - pull).norm());
  }
  EXPECT_TRUE(sleeper.broken.empty()) << sleeper.broken.front();
  EXPECT_TRUE(awake.broken.empty()) << awake.broken.front();
  EXPECT_EQ(asleep[18], sleeper.world().assembly.strip_vertices);
  EXPECT_GT(asleep.back(), 0) << "what the hand has not reached";
  EXPECT_LT(asleep.back(), asleep[18] - 30);
  EXPECT_LT(most, 1e-4);
  EXPECT_LT(apart, 0.05 * force);
}
TEST(Sleep, TapeRidesTheBodyItSleepsOn) {
  OnPlates scene(0.05);
  scene.setup.scene.gravity = Vec3(0, 0, -9.81);
  Body& plate = scene.plate("plate", -0.01, 0.06, Motion::dynamic);
  plate.velocity = Vec3(0.3, 0, 2);
  test::Simulation s(scene.setup);
  for (Vec3& v : s.state().v) v = plate.velocity;
  const auto mass = [&] {
    Real sum = s.world().assembly.bodies[0].mass.mass;
    for (int v = 0; v < s.world().assembly.strip_vertices; ++v) sum += s.world().assembly.mass[static_cast<std::size_t>(v)];
    return sum;
  }();
  s.run_to(0.4, [&](const test::Simulation& at) {
    const Vec3 thrown = mass * (Vec3(0.3, 0, 2) + at.state().time * Vec3(0, 0, -9.81));
    EXPECT_LT((at.report().momentum - thrown).norm(), 1e-6 * mass);
  });
  EXPECT_TRUE(s.broken.empty()) << s.broken.front();
  EXPECT_EQ(s.report().asleep, s.world().assembly.strip_vertices);
  EXPECT_EQ(asleep_on(s.state(), 0), s.report().asleep);
  const Pose& pose = s.state().bodies[0].pose;
  for (std::size_t v = 0; v < s.state().x.size(); ++v)
    EXPECT_LT((s.state().x[v] - apply(pose, s.state().sleepers->local[v])).norm(), 1e-12);
}
TEST(Sleep, TapeOverTwoBodiesWakesWhenOneOfThemMoves) {
  // At 0.25 s the right plate draws away by 60 um.
  const auto bridge = [](Real after, Real move) {
    OnPlates scene(0.1);
    scene.setup.scene.sleep.after = after, scene.setup.scene.sleep.move = move;
    scene.plate("left", -0.01, 0.049, Motion::fixed);
    Body& right = scene.plate("right", 0.051, 0.11, Motion::driven);
    Pose home = right.pose, away = home;
    away.position.x() += 6e-5;
    right.waypoints = {{0, home}, {0.25, home}, {0.3, away}};
    return test::Simulation(scene.setup);
  };
  test::Simulation awake = bridge(0, 0.05);
  awake.run_to(0.6);
  EXPECT_TRUE(awake.broken.empty()) << awake.broken.front();
  const Vec3 pull = awake.report().body_force[1];
  EXPECT_GT(pull.norm(), 0.1);
  for (Real move : {0.05, 0.01}) {  // [dhat]
    test::Simulation sleeper = bridge(kAfter, move);
    sleeper.run_to(0.24);
    EXPECT_GT(asleep_on(sleeper.state(), 0), 30);
    EXPECT_GT(asleep_on(sleeper.state(), 1), 30);
    const int before = sleeper.report().asleep;
    sleeper.run_to(0.31);
    EXPECT_LT(sleeper.report().asleep, before - 30);
    EXPECT_GT(sleeper.report().asleep, 0);
    sleeper.run_to(0.6);
    EXPECT_TRUE(sleeper.broken.empty()) << sleeper.broken.front();
    EXPECT_GT(sleeper.report().asleep, before - 10) << "where it lies now";
    EXPECT_LT(farthest(sleeper.state().x, awake.state().x), move * sleeper.world().setup.scene.dhat());
    EXPECT_LT((sleeper.report().body_force[1] - pull).norm(), move * pull.norm());
  }
}
TEST(Sleep, TapeThatIsTouchedWakesAndSleepsAgain) {
  OnPlates scene(0.05);
  scene.plate("table", -0.01, 0.06, Motion::fixed);
  Body& stamp = test::add_body(scene.setup, "stamp", box_mesh(Vec3(0.01, 0.01, 0.01), {1, 1, 1}), Motion::driven, Vec3(0.025, 0, 0.006));
  stamp.material = 1;
  Pose high = stamp.pose, low = high;
  low.position.z() = 0.005 + scene.setup.scene.strips[0].pose.position.z() + 2e-4;
  stamp.waypoints = {{0, high}, {0.25, high}, {0.35, low}, {0.6, low}, {0.7, high}};
  test::Simulation s(scene.setup);
  const int all = s.world().assembly.strip_vertices;
  std::vector<int> asleep;
  s.run_to(0.9, [&](const test::Simulation& at) { asleep.push_back(at.report().asleep); });
  EXPECT_TRUE(s.broken.empty()) << s.broken.front();
  EXPECT_EQ(asleep[22], all);
  EXPECT_LT(asleep[35], all - 10) << "it comes down";
  EXPECT_GT(asleep[35], 0) << "and only tape near it is touched";
  EXPECT_EQ(asleep[58], all) << "it rests on the tape";
  EXPECT_LT(asleep[61], all - 10) << "it leaves";
  EXPECT_EQ(asleep.back(), all);
}
TEST(Sleep, SavedAndResumedItGoesOnToTheBit) {
  OnPlates scene(0.05);
  scene.plate("table", -0.01, 0.06, Motion::fixed);
  Grip hand = test::hold("hand", scene.tip());
  hand.start = 0.2;
  hand.motion = {{0.2, 0.6, Vec3(0, 0, 0.012)}};
  scene.setup.scene.grips = {hand};
  test::Simulation through(scene.setup), second(scene.setup);
  const std::string file = (std::filesystem::temp_directory_path() / ("tape_sleep_test_" + std::to_string(getpid()) + ".h5")).string();
  for (Real time : {0.08, 0.19, 0.28}) {  // before tape sleeps, all asleep, some of it awake
    through.run_to(time);
    save_snapshot(file, through.world(), through.state());
    second.resume(file);
    EXPECT_EQ(second.state().hash(), through.state().hash());
    for (int k = 0; k < 8; ++k) through.step(), second.step();
    EXPECT_EQ(second.state().hash(), through.state().hash()) << time;
  }
  std::filesystem::remove(file);
}
TEST(Sleep, WhatWakesRemembersAllThatItDid) {
  OnPlates scene(0.05);
  scene.plate("table", -0.01, 0.06, Motion::fixed);
  test::Simulation s(scene.setup);
  s.run_to(0.04);
  const auto pairs = [](const State& state) { return std::get<MemoryOf<CohesiveZone>>(state.memory).pairs; };
  const auto before = pairs(s.state());
  s.run_to(0.2);
  EXPECT_TRUE(pairs(s.state()).empty());
  State state = s.state();
  wake_tape(s.world(), state);
  EXPECT_EQ(sleeping(state), 0);
  const auto after = pairs(state);
  ASSERT_EQ(after.size(), before.size());
  for (std::size_t k = 0; k < after.size(); ++k) {
    EXPECT_EQ(after[k].key(), before[k].key());
    EXPECT_EQ(after[k].worst, before[k].worst);
  }
}
