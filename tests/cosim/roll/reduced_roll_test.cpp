#include <gtest/gtest.h>
#include <unistd.h>

#include <Eigen/LU>
#include <cmath>
#include <filesystem>
#include <functional>
#include <numbers>

#include "cosim/roll/settled_roll.hpp"
#include "cosim/run/read_run.hpp"
#include "tape/bodies/free_flight.hpp"
#include "tape/math/rotation.hpp"
#include "tape/step/reduce.hpp"

using namespace tape;

namespace {
constexpr const char* kRoll = R"(film: vinyl_19mm
model: coh-r
gravity: [0, 0, 0]
time: {dt: 0.01, duration: 10}
strip: {cells_across: 3, cell_length: 0.003}
roll: {turns: 2, free_length: 0.02}
interfaces:
  - {between: [tape.sticky, tape], law: per_pair, beta0: 1, slip: bonding}
  - {between: [tape.sticky, hub], law: per_pair, beta0: 1, slip: bonding}
solver: {velocity_tol: 1.0e-4}
)";
World roll(const std::vector<std::string>& overrides = {}) {
  cosim::RunInput input = cosim::read_run(cosim::SceneFile::parse(kRoll, TAPE_SOURCE_DIR "/data/scenes/roll_test.yaml", overrides));
  cosim::place_roll(cosim::settle_roll(cosim::roll_alone(input.setup, 0), {}), 0, input.setup);
  return World::build(input.setup);
}

/// Momenta and energy of motion of everything in a state.
struct Moving {
  Vec3 p = Vec3::Zero(), L = Vec3::Zero();
  Real kinetic = 0;
  Moving(const World& world, const State& state) {
    const Carriage c = carry(world, state);
    for (std::size_t v = 0; v < state.x.size(); ++v) {
      p += c.mass[v] * state.v[v], L += c.mass[v] * state.x[v].cross(state.v[v]);
      kinetic += c.mass[v] * state.v[v].squaredNorm() / 2;
    }
    for (std::size_t b = 0; b < state.bodies.size(); ++b) {
      const BodyState& body = state.bodies[b];
      const Mat3 I = body.pose.rotation * inertia_tensor(c.body_mass[b].second) * body.pose.rotation.transpose();
      p += c.body_mass[b].mass * body.velocity;
      L += c.body_mass[b].mass * body.pose.position.cross(body.velocity) + body.angular_momentum;
      kinetic += c.body_mass[b].mass * body.velocity.squaredNorm() / 2 + body.angular_momentum.dot(I.inverse() * body.angular_momentum) / 2;
    }
  }
};
int members_of(const World& world, const State& state) {
  int n = 0;
  const Carriage c = carry(world, state);
  for (int v = 0; v < world.assembly.strip_vertices; ++v) n += c.owner[static_cast<std::size_t>(v)].body >= 0 ? 1 : 0;
  return n;
}
template <class T>
std::size_t pairs_of(const EffectMemory& memory) {
  return std::get<MemoryOf<T>>(memory).pairs.size();
}
/// Gives the cluster a velocity and a spin.
void launch(const World& world, State& state, const Vec3& velocity, const Vec3& spin) {
  BodyState& body = state.bodies[static_cast<std::size_t>(world.first_cluster())];
  body.velocity = velocity;
  body.angular_momentum = body.pose.rotation * inertia_tensor(state.clusters[0].mass.second) * body.pose.rotation.transpose() * spin;
}
struct File {
  std::filesystem::path path = std::filesystem::temp_directory_path() / ("tape-reduced-" + std::to_string(::getpid()) + ".h5");
  ~File() { std::filesystem::remove(path); }
};
}  // namespace

TEST(ReducedRoll, GivesBackItsTapeWithItsMotionUntilNothingIsLeft) {
  const World world = roll({"roll.turns=8"});
  State state = State::start(world);
  // 10 turns a second about the axis y, with some wobble, while it flies.
  launch(world, state, Vec3(0.4, -0.2, 0.1), 20 * std::numbers::pi * Vec3(0.1, 1, 0.05));
  const std::size_t pairs = pairs_of<Cohesion>(state.memory) + pairs_of<Cohesion>(*state.clusters[0].asleep);
  EXPECT_GT(pairs_of<Cohesion>(*state.clusters[0].asleep), pairs / 2);
  int releases = 0;
  for (; members_of(world, state) > 0 && releases < 2000; ++releases) {
    const State before = state;
    const Carriage carriage = carry(world, state);
    ASSERT_FALSE(carriage.next[0].empty()) << releases << " releases, members " << members_of(world, state);
    for (int v : carriage.next[0]) state.x[static_cast<std::size_t>(v)].z() += 1e-3;  // beyond the gate: a whole row passes at once
    const Moving was(world, state);
    const int members = members_of(world, state);
    ASSERT_TRUE(advance_fronts(world, carriage, before, state));
    const Moving is(world, state);
    EXPECT_LE((is.p - was.p).norm(), 1e-12 * was.p.norm());
    EXPECT_LE((is.L - was.L).norm(), 1e-12 * was.L.norm());
    EXPECT_LE(std::fabs(is.kinetic - was.kinetic), 1e-12 * was.kinetic);
    EXPECT_LE(members_of(world, state), members);
    for (std::size_t v = 0; v < state.clusters[0].distance->size(); ++v)
      ASSERT_LE((*state.clusters[0].distance)[v], (*before.clusters[0].distance)[v]) << "no tape goes back";
  }
  EXPECT_GT(releases, 200);
  EXPECT_EQ(members_of(world, state), 0);
  EXPECT_EQ(pairs_of<Cohesion>(*state.clusters[0].asleep), 0u);
  // Everything has come back as it was.
  State fresh = State::start(world);
  std::vector<Cohesion::Memory> all = std::get<MemoryOf<Cohesion>>(fresh.memory).pairs;
  const std::vector<Cohesion::Memory>&asleep = std::get<MemoryOf<Cohesion>>(*fresh.clusters[0].asleep).pairs,
        &now = std::get<MemoryOf<Cohesion>>(state.memory).pairs;
  all.insert(all.end(), asleep.begin(), asleep.end());
  std::ranges::sort(all, {}, [](const auto& m) { return m.key(); });
  ASSERT_EQ(now.size(), all.size());
  for (std::size_t i = 0; i < all.size(); ++i) {
    EXPECT_EQ(now[i].key(), all[i].key());
    EXPECT_EQ(now[i].beta, all[i].beta);
    EXPECT_EQ(now[i].slip, all[i].slip);
  }
  // The body that is left over rests, and steps go on without it.
  const std::unique_ptr<Stepper> stepper = make_stepper(Backend::cpu, world);
  State start = State::start(world);
  start.clusters[0].distance = std::make_shared<const std::vector<int>>(start.clusters[0].distance->size(), 0);
  EXPECT_TRUE(stepper->step(start).ok);
}

TEST(ReducedRoll, GivesBackAsManyRowsAsAStepHasTakenOff) {
  const World world = roll({"roll.turns=8"});
  State state = State::start(world);
  const State before = state;
  const Carriage carriage = carry(world, state);
  const Moving was(world, state);
  const auto collar = [&](std::size_t v) { return carriage.owner[v].body < 0 && (*before.clusters[0].distance)[v] > 0; };
  int taken = 0, one_edge = static_cast<int>(carriage.next[0].size());
  for (std::size_t v = 0; v < state.x.size(); ++v)
    if (collar(v)) state.x[v].z() += 1e-3, ++taken;  // beyond the gate
  ASSERT_GT(taken, 5 * one_edge);
  ASSERT_TRUE(advance_fronts(world, carriage, before, state));
  for (std::size_t v = 0; v < state.x.size(); ++v) {
    const int distance = (*state.clusters[0].distance)[v];
    if (collar(v)) {
      EXPECT_EQ(distance, 0) << v;
    } else if (carriage.owner[v].body >= 0) {
      EXPECT_GT(distance, 0) << v << ": it was rigid in the step";
    }
  }
  const Moving is(world, state);
  EXPECT_EQ((is.p - was.p).norm() + (is.L - was.L).norm(), 0) << "of a roll that rests";
}

TEST(ReducedRoll, FormsWithTheMomentumOfItsTape) {
  cosim::RunInput input = cosim::read_run(cosim::SceneFile::parse(kRoll, TAPE_SOURCE_DIR "/data/scenes/roll_test.yaml", {}));
  cosim::place_roll(cosim::settle_roll(cosim::roll_alone(input.setup, 0), {}), 0, input.setup);
  input.setup.scene.strips[0].velocity = Vec3(0.3, -0.1, 0.2);
  const World world = World::build(input.setup);
  const State state = State::start(world);
  const Moving motion(world, state);
  Vec3 p = Vec3::Zero(), L = Vec3::Zero();
  for (int v = 0; v < world.assembly.strip_vertices; ++v) {
    const auto i = static_cast<std::size_t>(v);
    p += world.assembly.mass[i] * world.assembly.v[i], L += world.assembly.mass[i] * world.assembly.x[i].cross(world.assembly.v[i]);
  }
  EXPECT_LE((motion.p - p).norm(), 1e-13 * p.norm());
  EXPECT_LE((motion.L - L).norm(), 1e-13 * L.norm());
}

namespace {
/// Angle [deg] by which the hub turns about y in some time, in a roll that spins as a whole and drags its free end along.
Real hub_angle(const char* model, Real dt, Real time, const std::string& seat = "0.2") {
  const World world = roll(
      {std::string("model=") + model, "time.dt=" + to_text(dt), "solver.velocity_tol=1e-5", "gravity=[0,0,-9.81]", "cluster.seat=" + seat});
  const std::unique_ptr<Stepper> stepper = make_stepper(Backend::cpu, world);
  State state = State::start(world);
  const auto steps = static_cast<int>(std::lround(time / dt));
  // The roll spins at two turns a second as a whole.
  const Vec3 spin(0, 4 * std::numbers::pi, 0), axis = state.bodies[0].pose.position;
  for (std::size_t v = 0; v < state.v.size(); ++v) state.v[v] = spin.cross(state.x[v] - axis);
  for (std::size_t b = 0; b < state.bodies.size(); ++b) {
    BodyState& body = state.bodies[b];
    const Mat3& R = body.pose.rotation;
    body.velocity = spin.cross(body.pose.position - axis);
    body.angular_momentum = R * inertia_tensor(body_mass(world, state, b).second) * R.transpose() * spin;
  }
  Real angle = 0;
  for (int k = 0; k < steps; ++k) {
    const Mat3 before = state.bodies[0].pose.rotation;
    EXPECT_TRUE(stepper->step(state).ok) << model << " step " << k;
    const Vec3 turned = (state.bodies[0].pose.rotation * before.transpose()).col(0);
    angle += std::atan2(-turned.z(), turned.x()) * 180 / std::numbers::pi;
  }
  return angle;
}
}  // namespace

TEST(ReducedRoll, TurnsAsTheFullShellDoes) {
  const Real full = hub_angle("coh-f", 1e-3, 0.3), reduced = hub_angle("coh-r", 1e-3, 0.3);
  EXPECT_NEAR(reduced, full, 1);
  EXPECT_GT(full, 60) << "with the free end hanging on";
}

TEST(ReducedRoll, GoesOnBitForBitFromASnapshotBeforeAndAfterARelease) {
  for (const char* model : {"coh-r", "bond-r"}) {
    const World world = roll({std::string("model=") + model, "cluster.gate_distance=0.02", "interfaces.0.break_force=0.05"});
    const std::unique_ptr<Stepper> stepper = make_stepper(Backend::cpu, world);
    State state = State::start(world);
    const auto tip = static_cast<std::size_t>(world.assembly.strips[0].vertices - 1);
    for (std::size_t v = tip - 27; v <= tip; ++v) state.v[v] = Vec3(0, 0, 20);  // the end is flung off the roll
    const File file;
    const State first = state;
    const int members = members_of(world, state);
    for (int part = 0; part < 4; ++part) {
      save_snapshot(file.path.string(), world, state);
      const std::unique_ptr<Stepper> other = make_stepper(Backend::cpu, world);
      State again = load_snapshot(file.path.string(), world);
      EXPECT_EQ(again.hash(), state.hash());
      for (int k = 0; k < 3; ++k) {
        ASSERT_TRUE(other->step(again).ok);
        ASSERT_TRUE(stepper->step(state).ok);
      }
      EXPECT_EQ(again.hash(), state.hash()) << model << ", part " << part;
    }
    EXPECT_LT(members_of(world, state), members) << model << ": nothing was released";
    State again = first, fresh = first;  // what has woken sleeps again
    ASSERT_TRUE(stepper->step(again).ok && make_stepper(Backend::cpu, world)->step(fresh).ok);
    EXPECT_EQ(again.hash(), fresh.hash()) << model;
  }
}

namespace {
/// A roll whose tape and hub adhere by a law without a memory of slip: where they stand says what they bear.
World roll_per_area(const std::string& seat) {
  return roll({"cluster.seat=" + seat, "interfaces.0.law=per_area", "interfaces.1.law=per_area", "interfaces.0.rest=0.8",
               "interfaces.1.rest=0.8", "interfaces.0.reach=0.8", "interfaces.1.reach=0.8"});
}
/// The state with the cluster moved against its hub.
State displaced(const World& world, State state, const Vec3& by, const Vec3& turn) {
  BodyState& body = state.bodies[static_cast<std::size_t>(world.first_cluster())];
  const Vec3 hub = state.bodies[0].pose.position;
  const Mat3 R = rotation_exp(turn);
  body.pose = {R * body.pose.rotation, hub + R * (body.pose.position - hub) + by};
  const Carriage c = carry(world, state);
  for (std::size_t v = 0; v < state.x.size(); ++v)
    if (c.owner[v].body >= 0) state.x[v] = apply(body.pose, c.local[v]);
  return state;
}
}  // namespace

// The form of a resting cluster beside the pairs that it stands for, which are awake in another world.
TEST(RestOnHub, StoresWhatThePairsStoreThatSleep) {
  const World resting = roll_per_area("0.1"), awake = roll_per_area("0");
  const std::unique_ptr<Stepper> at_rest = make_stepper(Backend::cpu, resting), other = make_stepper(Backend::cpu, awake);
  State a = State::start(resting), b = State::start(awake);
  const StepReport rests = at_rest->step(a);
  ASSERT_TRUE(rests.ok && other->step(b).ok && a.clusters[0].rest && !b.clusters[0].rest);
  EXPECT_LT(std::fabs(rests.woken), 1e-12 * at_rest->renew(a));
  const auto stored = [](Stepper& stepper, const World& world, const State& state, const Vec3& by, const Vec3& turn) {
    return stepper.renew(displaced(world, state, by, turn));
  };
  const Real d = 0.3 * a.clusters[0].rest->reach, angle = d / a.clusters[0].rest->radius;
  for (const auto& [by, turn] : {std::pair<Vec3, Vec3>{{d, 0, 0}, {0, 0, 0}},
                                 {{0, d, 0}, {0, 0, 0}},
                                 {{0, 0, d}, {0, 0, 0}},
                                 {{0, 0, 0}, {angle, 0, 0}},
                                 {{0, 0, 0}, {0, angle, 0}},
                                 {{d / 2, -d / 3, d / 4}, {-angle / 2, angle / 3, angle / 4}}}) {
    const auto change = [&](Stepper& stepper, const World& world, const State& state) {
      const Real there = stored(stepper, world, state, by, turn), back = stored(stepper, world, state, -by, -turn);
      const Real here = stored(stepper, world, state, Vec3::Zero(), Vec3::Zero());
      return std::pair{there - back, there + back - 2 * here};
    };
    const auto [slope_a, curvature_a] = change(*at_rest, resting, a);
    const auto [slope_b, curvature_b] = change(*other, awake, b);
    EXPECT_GT(curvature_b, 0);
    EXPECT_NEAR(curvature_a, curvature_b, 0.02 * curvature_b) << by.transpose() << ", " << turn.transpose();
    EXPECT_NEAR(slope_a, slope_b, 0.02 * curvature_b) << by.transpose() << ", " << turn.transpose();
  }
}

namespace {
/// The hub is pushed to and fro against its tape, by velocities as of a knock, and then left alone.
struct Knocked {
  Real creep = 0;  ///< [m] by which the cluster stands elsewhere on its hub afterwards
  int rested = 0;  ///< steps that started with the cluster at rest
  int woken = 0;   ///< steps at whose end it had come off its rest, or stood elsewhere
  Vec3 centre;     ///< [m] of the hub
};
Knocked knock(const std::string& seat, Real speed) {
  const World world = roll({"cluster.seat=" + seat, "interfaces.1.cn=0.25", "interfaces.1.ct=0.25"});
  const std::unique_ptr<Stepper> stepper = make_stepper(Backend::cpu, world);
  State state = State::start(world);
  const auto cluster = static_cast<std::size_t>(world.first_cluster());
  const auto place = [&] { return on_hub(state.bodies[0].pose, state.bodies[cluster].pose, state.clusters[0].centre); };
  Knocked out;
  const auto step = [&] {
    const std::shared_ptr<const Rest> rest = state.clusters[0].rest;
    out.rested += rest ? 1 : 0;
    EXPECT_TRUE(stepper->step(state).ok);
    out.woken += rest && state.clusters[0].rest != rest ? 1 : 0;
  };
  for (int k = 0; k < 10; ++k) step();
  const OnHub before = place();
  for (int k = 0; k < 12; ++k) {
    const Vec3 direction = k % 3 == 0 ? Vec3(1, 0, 0) : k % 3 == 1 ? Vec3(0, 1, 0.5) : Vec3(-1, -0.5, 0.7);
    state.bodies[0].velocity += speed * direction;
    state.bodies[0].angular_momentum += speed * Vec3(0, 1e-5, 0);
    for (int n = 0; n < 4; ++n) step();
  }
  for (int k = 0; k < 40; ++k) step();
  out.creep = displaced(before, 0.02, state.bodies[0].pose, state.bodies[cluster].pose, state.clusters[0].centre);
  out.centre = state.bodies[0].pose.position;
  return out;
}
}  // namespace

TEST(RestOnHub, WakesWhenItIsKnockedAndForgetsNothing) {
  const Knocked soft = knock("0.2", 5), soft_awake = knock("0", 5), hard = knock("0.2", 20), hard_awake = knock("0", 20);
  EXPECT_EQ(soft.rested, 97) << "all steps but the first";
  EXPECT_EQ(soft.woken, 0);
  EXPECT_LT((soft.centre - soft_awake.centre).norm(), 1e-7);
  EXPECT_GT(hard.rested, 50);
  EXPECT_GT(hard.woken, 10);
  EXPECT_EQ(hard_awake.rested, 0);
  for (const Knocked& each : {soft, soft_awake, hard, hard_awake}) EXPECT_LT(each.creep, 1e-6) << "dhat/200, however often it woke";
}
TEST(RestOnHub, TurnsTheHubAsPairsThatAreAwakeDo) { EXPECT_NEAR(hub_angle("coh-r", 1e-2, 0.3), hub_angle("coh-r", 1e-2, 0.3, "0"), 1e-3); }
