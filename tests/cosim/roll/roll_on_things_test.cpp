// Reduced rolls on tables, on axles, between pads and on their own tape, in the scenes that ship.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "cosim/roll/settled_roll.hpp"
#include "cosim/run/read_run.hpp"
#include "tape/step/reduce.hpp"
#include "tests/support/simulation.hpp"

using namespace tape;
using test::Simulation;

namespace {
tape::Setup scene(const std::string& name, const std::vector<std::string>& overrides) {
  tape::Setup setup =
      cosim::read_run(cosim::SceneFile::load(std::string(TAPE_SOURCE_DIR) + "/data/scenes/" + name + ".yaml", overrides)).setup;
  cosim::place_roll(cosim::settle_roll(cosim::roll_alone(setup, 0), {}), 0, setup);
  return setup;
}
const Winding& winding(const Simulation& s) { return *s.world().setup.scene.strips[0].winding; }
const BodyState& hub(const Simulation& s) { return s.state().bodies[static_cast<std::size_t>(winding(s).hub)]; }
/// 1 + I/(m R^2) of hub and wound tape.
Real rolling_mass(const Simulation& s) {
  const Winding& w = winding(s);
  const AxialMass core = core_mass({}), tape = annulus_mass(w, s.world().setup.scene.films[0]);
  const Real R = annulus_radius(w);
  return 1 + (core.inertia + tape.inertia) / ((core.mass + tape.mass) * R * R);
}
/// [rad] about the hub's axis since the start, below half a turn.
Real turned(const Simulation& s) {
  const Mat3 turn =
      State::start(s.world()).bodies[static_cast<std::size_t>(winding(s).hub)].pose.rotation.transpose() * hub(s).pose.rotation;
  return std::atan2(turn(1, 0) - turn(0, 1), turn(0, 0) + turn(1, 1));
}
Vec3 travelled(const Simulation& s) {
  return hub(s).pose.position - State::start(s.world()).bodies[static_cast<std::size_t>(winding(s).hub)].pose.position;
}
long members(const World& world, const State& state) {
  const std::vector<TapePart> parts = tape_parts(world, state);
  return std::count(parts.begin(), parts.end(), TapePart::cluster);
}
/// [m] along the tape, where the last of it adheres.
Real boundary(const Simulation& s) {
  Real end = 0;
  for (const AdhesionReport& a : s.report().adhesion) end = std::max(end, a.to);
  return end;
}
}  // namespace

TEST(RollOnThings, RollsDownATableAndSlidesWhereThereIsNoFriction) {
  // Implicit Euler goes a t (t + dt)/2. A roll is a polygon: from a corner to a flat it gives or takes up to 0.06 mm of height, of the
  // 8 mm that it comes down in all.
  const Real along = 9.81 * std::sin(8 * std::numbers::pi / 180), time = 0.4, square = time * (time + 5e-3);
  {
    Simulation rolling(scene("roll_on_table", {"roll.turns=8", "roll.position=[0,0,0.0229]"}));
    rolling.run_to(time);
    EXPECT_TRUE(rolling.broken.empty()) << rolling.broken.front();
    const Real way = along / rolling_mass(rolling) * square / 2;
    EXPECT_NEAR(travelled(rolling).x(), way, 0.03 * way);
    EXPECT_NEAR(std::fabs(turned(rolling)), travelled(rolling).x() / annulus_radius(winding(rolling)), 0.02 * std::fabs(turned(rolling)));
  }
  Simulation sliding(scene("roll_on_table", {"roll.turns=8", "roll.position=[0,0,0.0229]", "materials.default.mu=0"}));
  sliding.run_to(time);
  EXPECT_TRUE(sliding.broken.empty()) << sliding.broken.front();
  EXPECT_NEAR(travelled(sliding).x(), along * square / 2, 0.01 * along * square / 2);
  EXPECT_LT(std::fabs(turned(sliding)), 2 * std::numbers::pi / 42 / 2) << "from a corner to a flat";
}

TEST(RollOnThings, OnAnAxleItGivesTapeToWhoPulls) {
  Simulation s(scene("roll_on_axle", {"roll.turns=2"}));
  s.run_to(1);
  EXPECT_TRUE(s.broken.empty()) << s.broken.front();
  EXPECT_LT(travelled(s).norm(), 5e-5) << "the axle holds its place";
  EXPECT_GT(std::fabs(turned(s)), 0.2);
  EXPECT_LT(members(s.world(), s.state()), members(s.world(), State::start(s.world())));
  EXPECT_LE(std::fabs(s.report().axle_torque[0]), 1e-3 + 1e-12);
}

TEST(RollOnThings, UnwindsAsItFalls) {
  Simulation s(scene("roll_yoyo", {}));
  s.run_to(0.1);
  EXPECT_TRUE(s.broken.empty()) << s.broken.front();
  const Real way = 9.81 / rolling_mass(s) * 0.1 * 0.1 / 2;
  EXPECT_NEAR(-travelled(s).z(), way, 0.015 * way) << "peeling takes a hundredth";
}

TEST(LongRollOnThings, PaysOutAsTheFullShellDoes) {
  Simulation full(scene("payout", {"model=coh-f"})), reduced(scene("payout", {"model=coh-r"}));
  full.check_intersections = reduced.check_intersections = false;
  full.step(), reduced.step();
  const Real at_first = boundary(reduced), row = winding(full).cell;
  for (int k = 0; k < 180; ++k) {
    full.step(), reduced.step();
    Real apart = 0;  // of the free tape
    for (std::size_t v = 0; v < reduced.state().x.size(); ++v)
      if ((*reduced.state().clusters[0].distance)[v] == 0) apart = std::max(apart, (full.state().x[v] - reduced.state().x[v]).norm());
    EXPECT_LT(apart, 2 * row) << "step " << k << ": rows let go one by one, not in the same steps";
  }
  EXPECT_TRUE(full.broken.empty() && reduced.broken.empty());
  EXPECT_LT(boundary(reduced), at_first - 5 * row) << "rows have been let go";
}

TEST(LongRollOnThings, BetweenPadsItIsLiftedAndRolled) {
  Simulation s(scene("roll_pinched", {"roll.turns=2"}));
  s.run_to(2.5);
  EXPECT_TRUE(s.broken.empty()) << s.broken.front();
  const Real R = annulus_radius(winding(s));
  EXPECT_NEAR(travelled(s).z(), 0.03 - (0.0235 - R), 2e-4) << "it has fallen on the table before";
  const Real angle = 0.01 / R;  // each pad goes 10 mm: what rolls between them turns by that way
  EXPECT_NEAR(std::fabs(turned(s)), angle, 0.03 * angle);
}
TEST(LongRollOnThings, LaidBackOnTheRollTapeSticksAgainAndStaysFree) {
  Simulation s(scene("reattach", {}));
  s.step();
  const Real at_first = boundary(s);
  s.run_to(2);
  EXPECT_LT(boundary(s), at_first - 0.003) << "it has been peeled";
  const long left = members(s.world(), s.state());
  s.run_to(5);
  EXPECT_TRUE(s.broken.empty()) << s.broken.front();
  EXPECT_GT(boundary(s), at_first + 0.003) << "and more of it sticks than at the start";
  EXPECT_LE(members(s.world(), s.state()), left);
}
