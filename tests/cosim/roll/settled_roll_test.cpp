#include "cosim/roll/settled_roll.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <map>

#include "cosim/roll/roll_figures.hpp"
#include "cosim/run/read_run.hpp"
#include "tape/bodies/free_flight.hpp"
#include "tape/contact/intersection.hpp"
#include "tape/step/engagement.hpp"

using namespace tape;

namespace {
constexpr const char* kRoll = R"(film: vinyl_19mm
time: {dt: 0.01, duration: 10}
roll: {turns: 2, free_length: 0.02}
interfaces:
  - {between: [tape.sticky, tape], law: per_pair, beta0: 1}
  - {between: [tape.sticky, hub], law: per_pair, beta0: 1}
)";
cosim::RunInput roll_input(const std::vector<std::string>& overrides = {}) {
  return cosim::read_run(cosim::SceneFile::parse(kRoll, TAPE_SOURCE_DIR "/data/scenes/roll_test.yaml", overrides));
}
cosim::SettledRoll settled(const std::vector<std::string>& overrides = {}) {
  return cosim::settle_roll(cosim::roll_alone(roll_input(overrides).setup, 0), {});
}
std::map<std::string, Real> figures(const cosim::SettledRoll& roll) {
  const auto list = cosim::roll_figures(roll.world, roll.state, 0);
  return {list.begin(), list.end()};
}
/// Largest distance from the axis of the tape that the winding calls wound.
Real wound_radius(const World& world, const State& state) {
  const Winding& w = *world.setup.scene.strips[0].winding;
  const Pose& hub = state.bodies[0].pose;
  Real most = 0;
  for (std::size_t v = 0; v < state.x.size(); ++v)
    if (world.assembly.rest[v].x() < w.wound())
      most = std::max(most, (hub.rotation.transpose() * (state.x[v] - hub.position)).head<2>().norm());
  return most;
}
/// Whether a roll comes to rest, as long, heavy and wide as the formulas of its spiral say.
void expect_as_wound(const std::vector<std::string>& change) {
  const cosim::SettledRoll roll = settled(change);
  EXPECT_LE(roll.report.speed, 1e-7) << "0.1 um in a step of 1 s";
  EXPECT_EQ(find_intersections(roll.world.surface, vertex_positions(roll.world, roll.state)).count, 0);
  const Winding& w = *roll.world.setup.scene.strips[0].winding;
  const std::map<std::string, Real> f = figures(roll);
  EXPECT_NEAR(f.at("turns"), w.turns, 0.02) << "rows are 1/42 of a turn apart";
  EXPECT_NEAR(f.at("wound_length_m"), annulus_length(w), 5e-3 * annulus_length(w) + w.cell) << "a row more or less";
  EXPECT_NEAR(f.at("outer_radius_m"), annulus_radius(w), 5e-3 * annulus_radius(w));
  const AxialMass core = core_mass({}), tape = annulus_mass(w, roll.world.setup.scene.films[0]);
  EXPECT_NEAR(f.at("roll_mass_kg"), core.mass + tape.mass, 5e-3 * (core.mass + tape.mass));
  EXPECT_NEAR(f.at("roll_inertia_kg_m2"), core.inertia + tape.inertia, 5e-3 * (core.inertia + tape.inertia));
}
struct File {
  std::filesystem::path path = std::filesystem::temp_directory_path() / ("tape-roll-" + std::to_string(::getpid()) + ".h5");
  ~File() { std::filesystem::remove(path); }
};
}  // namespace

TEST(SettledRoll, ComesToRestAsLongHeavyAndWideAsItWasWound) {
  for (const std::vector<std::string>& change :
       {std::vector<std::string>{}, {"roll.turns=8"}, {"interfaces.0.law=bond", "interfaces.1.law=bond"}, {"strip.pattern=crossed"}})
    expect_as_wound(change);
}
TEST(LongSettledRoll, OfManyTurnsIsAsLongHeavyAndWideAsItWasWound) {
  for (const char* turns : {"16", "24", "32"}) expect_as_wound({std::string("roll.turns=") + turns});
}
TEST(SettledRoll, WoundTheOtherWayIsItsMirrorImage) {
  const cosim::SettledRoll roll = settled();
  std::vector<Vec3> tips;
  for (const char* sense : {"left", "right"}) {
    cosim::RunInput input = roll_input({std::string("roll.sense=") + sense});
    cosim::place_roll(roll, 0, input.setup);
    const World world = World::build(input.setup);
    tips.push_back(State::start(world).x.back());
  }
  EXPECT_LT((tips[0] - Vec3(-tips[1].x(), -tips[1].y(), tips[1].z())).norm(), 1e-12);
}

TEST(SettledRoll, TapeThatAdheresToItselfFarFromTheRollIsNotWound) {
  cosim::SettledRoll roll = settled({"roll.free_length=0.1"});
  const Real before = figures(roll).at("wound_length_m");
  const int tip = static_cast<int>(roll.state.x.size()) - 1, last = roll.world.assembly.strips[0].triangles - 1;
  auto& pairs = std::get<MemoryOf<Cohesion>>(roll.state.memory).pairs;
  ASSERT_FALSE(pairs.empty());
  auto pair = pairs.front();
  pair.vertex = tip - 20, pair.triangle = last, pair.beta = 1;  // the tip's cell on a row some cells before it
  pairs.push_back(pair);
  EXPECT_EQ(figures(roll).at("wound_length_m"), before);
  pair.vertex = 10;  // the tip's cell on the first turn: now all of the tape is held
  pairs.push_back(pair);
  EXPECT_GT(figures(roll).at("wound_length_m"), before + 0.08);
}
/// What sleeps in its cluster is wound all the same.
TEST(SettledRoll, ReducedItMeasuresAsTheFullShell) {
  cosim::RunInput input = roll_input({"roll.turns=5", "model=coh-r", "cluster.collar=1"});
  cosim::place_roll(settled({"roll.turns=5"}), 0, input.setup);
  const World world = World::build(input.setup);
  State state = State::start(world);
  ASSERT_TRUE(make_stepper(Backend::cpu, world)->step(state).ok);
  ASSERT_GT(std::get<MemoryOf<Cohesion>>(*state.clusters.at(0).asleep).pairs.size(),
            std::get<MemoryOf<Cohesion>>(state.memory).pairs.size());
  const auto measured = cosim::roll_figures(world, state, 0);
  EXPECT_EQ(measured[0].first, "turns");
  EXPECT_NEAR(measured[0].second, 5, 0.02) << "rows are 1/42 of a turn apart";
  const std::vector<Real> engagement = vertex_engagement(world, state);
  const Winding& w = *world.setup.scene.strips[0].winding;
  int held = 0, wound = 0;
  for (int v = 0; v < world.assembly.strips[0].vertices; ++v) {
    if (world.assembly.rest[static_cast<std::size_t>(v)].x() > w.wound()) continue;
    ++wound, held += engagement[static_cast<std::size_t>(v)] > 0;
  }
  EXPECT_GT(held, 0.95 * wound);
}
/// Area that lies in the band at the start sticks; from then on the law decides, or each row would draw the next one in.
TEST(SettledRoll, ByAreaItsFreeEndStaysFree) {
  const std::vector<std::string> by_area = {"roll.turns=2.2", "strip.cells_across=3", "strip.cell_length=0.003",
                                            "interfaces.0.law=per_area", "interfaces.1.law=per_area"};
  const cosim::SettledRoll roll = settled(by_area);
  const Winding& w = *roll.world.setup.scene.strips[0].winding;
  EXPECT_NEAR(figures(roll).at("wound_length_m"), w.wound(), 2 * w.cell);
}
TEST(SettledRoll, AnEffectThatIsOffHoldsNothingTogether) {
  EXPECT_TRUE(cosim::holds_together(roll_input().setup, 0));
  EXPECT_FALSE(cosim::holds_together(roll_input({"effects.cohesion=off"}).setup, 0));
  const std::vector<std::string> bonds = {"interfaces.0.law=bond", "interfaces.1.law=bond", "effects.cohesion=off"};
  EXPECT_TRUE(cosim::holds_together(roll_input(bonds).setup, 0));
  EXPECT_NEAR(figures(settled(bonds)).at("turns"), 2, 0.02) << "cohesion settles it all the same";
  for (const auto& change : {"effects.cohesion=off", "interfaces.0.law=none"})
    EXPECT_THROW(roll_input({"model=coh-r", change}), InputError) << change;
}
TEST(SettledRoll, StaysWoundWhereItAdheresAndSpringsOpenWhereItDoesNot) {
  // Slip from bonding: counted from each step, the layers creep (cosim/roll/README.md), four Newton iterations a step.
  cosim::RunInput input = roll_input({"gravity=[0,0,0]", "interfaces.0.slip=bonding", "interfaces.1.slip=bonding"});
  cosim::place_roll(settled(), 0, input.setup);
  for (bool adheres : {true, false}) {
    tape::Setup setup = input.setup;
    if (!adheres) setup.scene.adhesives.clear(), setup.memory = {};
    const World world = World::build(setup);
    const std::unique_ptr<Stepper> stepper = make_stepper(Backend::cpu, world);
    State state = State::start(world);
    const Real before = wound_radius(world, state);
    for (int i = 0; i < (adheres ? 1000 : 200); ++i) ASSERT_TRUE(stepper->step(state).ok) << i;
    if (adheres)
      EXPECT_LT(wound_radius(world, state), 1.02 * before);
    else
      EXPECT_GT(wound_radius(world, state), 1.25 * before);
  }
}

TEST(LongSettledRoll, StaysWoundThoughItsLayersCreep) {  // slip from the start of each step, the default
  cosim::RunInput input = roll_input({"gravity=[0,0,0]"});
  cosim::place_roll(settled(), 0, input.setup);
  const World world = World::build(input.setup);
  const std::unique_ptr<Stepper> stepper = make_stepper(Backend::cpu, world);
  State state = State::start(world);
  const Real before = wound_radius(world, state);
  for (int i = 0; i < 1000; ++i) ASSERT_TRUE(stepper->step(state).ok) << i;
  EXPECT_LT(wound_radius(world, state), 1.02 * before);
}

TEST(SettledRoll, FallsAsOneBodyUntilItTouches) {
  for (const char* tolerance : {"1e-1", "1e-2", "1e-3"}) {
    cosim::RunInput input = roll_input({std::string("solver.velocity_tol=") + tolerance});
    cosim::place_roll(settled(), 0, input.setup);
    const World world = World::build(input.setup);
    const std::unique_ptr<Stepper> stepper = make_stepper(Backend::cpu, world);
    State state = State::start(world);
    constexpr int kSteps = 20;
    for (int i = 0; i < kSteps; ++i) ASSERT_TRUE(stepper->step(state).ok);
    const Real dt = 0.01, fallen = 9.81 * dt * dt * kSteps * (kSteps + 1) / 2;  // implicit Euler
    EXPECT_NEAR(-state.bodies[0].pose.position.z(), fallen, 0.01 * fallen) << tolerance;
  }
}

TEST(SettledRoll, TurnsFarInAStepInAFewNewtonIterations) {  // on chords its first update would make it 2 % wider
  for (const char* model : {"coh-f", "coh-r"}) {
    cosim::RunInput input =
        roll_input({"gravity=[0,0,0]", "interfaces.0.slip=bonding", "interfaces.1.slip=bonding", std::string("model=") + model});
    cosim::place_roll(settled(), 0, input.setup);
    const World world = World::build(input.setup);
    const std::unique_ptr<Stepper> stepper = make_stepper(Backend::cpu, world);
    State state = State::start(world);
    const Pose hub = state.bodies[0].pose;
    const Vec3 spin = hub.rotation * Vec3(0, 0, 20);  // rad/s, about the hub's axis
    for (std::size_t v = 0; v < state.v.size(); ++v) state.v[v] = spin.cross(state.x[v] - hub.position);
    for (std::size_t b = 0; b < state.bodies.size(); ++b) {
      BodyState& body = state.bodies[b];
      const Mat3& R = body.pose.rotation;
      body.velocity = spin.cross(body.pose.position - hub.position);
      body.angular_momentum = R * inertia_tensor(body_mass(world, state, b).second) * R.transpose() * spin;
    }
    for (int k = 0; k < 5; ++k) {
      const StepReport report = stepper->step(state);
      ASSERT_TRUE(report.ok) << report.failure;
      EXPECT_LE(report.newton, 8) << model << ", step " << k << ": the shell on chords takes 20 to 25, the cluster on straight ways 11";
    }
  }
}

TEST(SettledRoll, IsKeptToTheBitAndOnlyForItsOwnSettings) {
  const cosim::SettledRoll roll = settled();
  const File file;
  cosim::save_roll(file.path, roll);
  const cosim::SettledRoll again = cosim::load_roll(file.path, cosim::roll_alone(roll_input().setup, 0));
  EXPECT_EQ(again.state.hash(), roll.state.hash());
  EXPECT_EQ(cosim::load_roll(file.path, cosim::roll_alone(roll_input({"solver.velocity_tol=1e-3", "time.dt=0.005"}).setup, 0)).state.hash(),
            roll.state.hash())
      << "what concerns the run is not the roll's";
  try {
    cosim::load_roll(file.path, cosim::roll_alone(roll_input({"interfaces.0.cn=2"}).setup, 0));
    ADD_FAILURE() << "accepted";
  } catch (const InputError& e) {
    EXPECT_NE(std::string(e.what()).find("cn = 1, the scene says"), std::string::npos) << e.what();
  }
}

TEST(SettledRoll, AdheresInASceneAsItDidAlone) {
  const cosim::SettledRoll roll = settled();
  cosim::RunInput input = cosim::read_run(cosim::SceneFile::parse(
      std::string(kRoll) +
          "bodies: {table: {shape: box, size: [1, 1, 0.1], position: [0, 0, -1]}}\nstrips: [{length: 0.05, position: [1, 1, 1]}]\n",
      TAPE_SOURCE_DIR "/data/scenes/roll_test.yaml", {"roll.position=[0.1,0.2,0.3]", "roll.rotation_deg=[30,40,50]"}));
  cosim::place_roll(roll, 0, input.setup);
  const World world = World::build(input.setup);
  const State state = State::start(world);
  const auto& alone = std::get<MemoryOf<Cohesion>>(roll.state.memory).pairs;
  const auto& placed = std::get<MemoryOf<Cohesion>>(state.memory).pairs;
  ASSERT_EQ(placed.size(), alone.size());
  const std::vector<Vec3> x = vertex_positions(world, state), x_alone = vertex_positions(roll.world, roll.state);
  for (std::size_t i = 0; i < placed.size(); ++i) {
    const auto distance = [](const World& w, const std::vector<Vec3>& at, const VertexTriangle& m) {
      return (at[m.vertex] - at[w.assembly.triangles[m.triangle][0]]).norm();
    };
    ASSERT_NEAR(distance(world, x, placed[i]), distance(roll.world, x_alone, alone[i]), 1e-14);
    ASSERT_EQ(placed[i].beta, alone[i].beta);
  }
}
