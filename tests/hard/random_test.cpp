#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "tape/math/rotation.hpp"
#include "tape/model/primitives.hpp"
#include "tests/hard/hard_case.hpp"
using namespace tape;
using test::Simulation;

namespace {
/// Strips and bodies of random shape, speed and settings thrown together over a table; a hand drags, a plate presses.
class RandomScene {
 public:
  explicit RandomScene(unsigned seed) : generator_(seed) {
    const bool packaging = chance(0.25);
    setup_ = test::strip_setup(test::flat_strip(0.05, 3, Vec3::Zero()));
    if (packaging) setup_.scene.films = {test::packaging_film()};
    setup_.scene.strips.clear();
    setup_.scene.time.dt = std::pow(10, number(-3, -1.5));
    setup_.newton.velocity_tol = std::pow(10, number(-4, -2));
    setup_.newton.hessian = chance(0.2) ? HessianMode::projected : HessianMode::exact;
    setup_.newton.stop = chance(0.2) ? StopRule::work : StopRule::velocity;
    setup_.scene.materials[0].mu = chance(0.2) ? 0 : number(0.05, 1.2);
    const int strips = count(1, 3);
    for (int k = 0; k < strips; ++k) add_strip(k);
    test::add_body(setup_, "table", box_mesh(Vec3(0.4, 0.4, 0.01), Index3(count(1, 8), count(1, 8), 1)), Motion::fixed, Vec3(0, 0, -0.005));
    for (int k = count(1, 4); k-- > 0;) add_fixed(k);
    for (int k = count(0, 3); k-- > 0;) add_loose(k, strips);
    if (chance(0.5)) add_hand();
    if (chance(0.3)) add_press();
  }
  const Setup& setup() const { return setup_; }

 private:
  Real number(Real low, Real high) { return std::uniform_real_distribution<Real>(low, high)(generator_); }
  int count(int low, int high) { return std::uniform_int_distribution<int>(low, high)(generator_); }
  bool chance(Real p) { return number(0, 1) < p; }
  Vec3 vector(Real size) {
    const Real x = number(-size, size), y = number(-size, size);
    return {x, y, number(-size, size)};
  }
  TriangleMesh shape() {
    const Real a = number(0.005, 0.015), b = number(0.01, 0.025);
    switch (count(0, 6)) {
      case 0:
        return box_mesh(Vec3(b, 2 * a, a));
      case 1:
        return cylinder_mesh(a, b, count(6, 40), 1);
      case 2:
        return sphere_mesh(a, count(1, 3));
      case 3:
        return wedge_mesh(Vec3(a, b, a));
      case 4:
        return spike_mesh(a / 2, b, count(3, 8));
      case 5:
        return ring_mesh(a / 2, a, b / 2, count(8, 40), 1);
      default:
        return box_mesh(Vec3(0.03, 0.03, 0.0006));
    }
  }
  void add_strip(int k) {
    Strip strip = test::flat_strip(number(0.03, 0.12), count(2, 6), Vec3::Zero());
    strip.name = "tape" + std::to_string(k);
    strip.mesh.pattern = static_cast<MeshPattern>(count(0, 3));
    strip.pose.rotation = rotation_exp(Vec3(0, 0, number(-3, 3))) * rotation_exp(vector(0.1));
    strip.pose.position = Vec3(0, 0, 0.09 + 0.03 * k) - strip.pose.rotation * Vec3(strip.mesh.length / 2, 0, 0);
    strip.velocity = vector(1) - Vec3(0, 0, 1);
    setup_.scene.strips.push_back(strip);
  }
  void add_fixed(int k) {
    Body& body =
        test::add_body(setup_, "post" + std::to_string(k), shape(), Motion::fixed, Vec3(-0.075 + 0.05 * k, number(-0.02, 0.02), 0.03));
    body.pose.rotation = rotation_exp(vector(2));
  }
  void add_loose(int k, int strips) {
    const Vec3 above(-0.04 + 0.04 * k, number(-0.01, 0.01), 0.12 + 0.03 * strips + 0.035 * k);
    Body& body = test::add_body(setup_, "loose" + std::to_string(k), shape(), Motion::dynamic, above);
    body.pose.rotation = rotation_exp(vector(3));
    body.velocity = vector(1) - Vec3(0, 0, 1.5);
    body.angular_velocity = vector(20);
    body.density = std::pow(10, number(2, 4));
  }
  void add_hand() {
    Grip hand;
    hand.name = "hand";
    hand.what = {.object = "tape0", .vertices = {0, 1, 2}, .points = {}};
    const Vec3 first = vector(0.08);
    hand.motion = {{0.02, 0.13, first}, {0.15, 0.15, vector(0.08) + Vec3(0, 0, 0.05) - first}};
    if (chance(0.3)) hand.end = 0.2;
    setup_.scene.grips.push_back(hand);
  }
  void add_press() {
    Body& plate = test::add_body(setup_, "press", box_mesh(Vec3(0.05, 0.05, 0.01)), Motion::driven, Vec3(0, 0, 0.35));
    Waypoint open{.time = 0.05, .pose = plate.pose}, closed{.time = 0.3, .pose = plate.pose};
    closed.pose = {rotation_exp(vector(0.3)), Vec3(0, 0, number(0.13, 0.18))};
    plate.waypoints = {open, closed};
  }

  std::mt19937_64 generator_;
  Setup setup_;
};

class LongRandomScenes : public testing::TestWithParam<unsigned> {};
}  // namespace

/// The list at the head of checks.md part 9, but for energy: tumbling polyhedra gain O(dt^2) a step (own_rolled_over says why). Limits may
/// be reached, and are reported: in 160 seeds, steps of up to 30 ms, five had one step in parts; CCD was capped in six steps.
TEST_P(LongRandomScenes, KeepTheirPromises) {
  const RandomScene scene(GetParam());
  Simulation simulation(scene.setup());
  simulation.may_reach_limits = true;
  simulation.run_to(0.4);
  const NewtonParams& newton = scene.setup().newton;
  std::printf("random %3u: %4d steps  %5.1f Newton a step (max %4d)  smallest gap %9.2e m  retried %d  capped %d  %s %s %.0e m/s  %s\n",
              GetParam(), simulation.state().step, simulation.newton_sum / std::max<Real>(1, simulation.state().step),
              simulation.newton_max, simulation.min_gap, simulation.retried, simulation.ccd_capped, to_text(newton.hessian).c_str(),
              to_text(newton.stop).c_str(), newton.velocity_tol, simulation.broken.empty() ? "ok" : "BROKEN");
  for (const std::string& what : simulation.broken) ADD_FAILURE() << what;
  EXPECT_LE(simulation.retried, 1);
}
INSTANTIATE_TEST_SUITE_P(Seeds, LongRandomScenes, testing::Range(0u, 40u));
