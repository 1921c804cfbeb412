#include "cosim/run/event_watch.hpp"

#include <gtest/gtest.h>

#include "cosim/run/conditions.hpp"
#include "cosim/run/run_log.hpp"
#include "tests/support/simulation.hpp"

namespace {
using cosim::Event;
using cosim::Quantity;
/// A strip that falls.
struct Falling {
  tape::World world = tape::World::build([] {
    tape::Setup setup = tape::test::strip_setup(tape::test::flat_strip(0.02, 2, tape::Vec3(0, 0, 1)));
    setup.scene.time.duration = 0.5;
    setup.scene.events = 2;
    return setup;
  }());
  tape::State state = tape::State::start(world);
  std::unique_ptr<tape::Stepper> stepper = make_stepper(tape::Backend::cpu, world);
  cosim::RunLog run(std::vector<Event> events, int steps = -1) {
    return cosim::simulate(world, *stepper, state, {.max_steps = steps, .events = std::move(events)});
  }
};
const Event kLow{.claim = {.quantity = Quantity::height, .things = {"tape.tip"}, .above = false, .level = 0.8}, .start = 0, .timeout = 1};
}  // namespace

/// Implicit Euler falls by g dt^2 n (n + 1)/2: 0.2 m lie behind it after step 20 (20.6 cm), not after step 19 (18.6 cm).
TEST(EventWatch, NotesTheStepThatBringsItAbout) {
  Falling strip;
  const Event after{
      .claim = {.quantity = Quantity::speed, .things = {"tape"}, .above = true, .level = 100}, .start = {0.1, 0}, .timeout = 0.05};
  const cosim::RunLog log = strip.run({kLow, after});
  EXPECT_NEAR(strip.state.events[0], 0.20, 1e-12);
  EXPECT_NEAR(strip.state.events[1], 0.35, 1e-12) << "0.1 s after the first it starts, 0.05 s later its time is over";
  const std::vector<cosim::Condition> conditions = check_conditions(strip.world, log);
  const auto of = [&](const std::string& name) { return std::ranges::find(conditions, name, &cosim::Condition::name); };
  EXPECT_TRUE(of("height of tape.tip below 0.8 m within 1 s")->met);
  EXPECT_FALSE(of("speed of tape above 100 m/s within 0.05 s")->met);
}
TEST(EventWatch, WhatHasHappenedStaysSoAfterASnapshot) {
  Falling first, second;
  first.run({kLow, kLow}, 25);
  const std::string file = testing::TempDir() + "/events.h5";
  tape::save_snapshot(file, first.world, first.state);
  second.state = tape::load_snapshot(file, second.world);
  EXPECT_EQ(second.state.events, first.state.events);
  EXPECT_EQ(second.state.hash(), first.state.hash());
  second.state.events[1] = 0.1;
  EXPECT_NE(second.state.hash(), first.state.hash());
}
