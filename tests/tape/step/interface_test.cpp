// What an interface has in place of what its materials or the scene say.
#include <gtest/gtest.h>

#include "tape/model/primitives.hpp"
#include "tests/support/simulation.hpp"
using namespace tape;
using test::Simulation;

namespace {
/// Two flat blocks that come to rest on a plane, the second ten times as heavy. @return [m] heights of their under sides
std::pair<Real, Real> resting_heights(Real kappa_under_the_heavy_one) {
  Setup setup;
  Scene& scene = setup.scene;
  scene.contact.dhat = 1e-4;
  scene.gravity = Vec3(0, 0, -9.81);
  scene.time.dt = 0.01;
  setup.newton.velocity_tol = 1e-8;
  scene.materials.push_back({"heavy", scene.materials[0].mu});
  scene.barriers = {{0, 1, kappa_under_the_heavy_one}};
  test::add_body(setup, "plane", box_mesh(Vec3(0.4, 0.2, 0.01)), Motion::fixed, Vec3(0, 0, -0.005));
  for (const Real mass : {0.01, 0.1}) {
    Body& block = test::add_body(setup, mass < 0.05 ? "light" : "heavy", box_mesh(Vec3(0.02, 0.02, 0.002)), Motion::dynamic,
                                 Vec3(mass < 0.05 ? -0.1 : 0.1, 0, 0.00108));
    block.mass = mass;
    block.material = mass < 0.05 ? 0 : 1;
  }
  Simulation simulation(setup);
  simulation.run_to(1);
  EXPECT_TRUE(simulation.broken.empty()) << simulation.broken.front();
  return {simulation.state().bodies[1].pose.position.z() - 0.001, simulation.state().bodies[2].pose.position.z() - 0.001};
}
}  // namespace

// The barrier's force is proportional to kappa: ten times the load at ten times the stiffness leaves the same gap.
TEST(Interface, ABlockTenTimesAsHeavyRestsAsHighWhereTheBarrierIsTenTimesAsStiff) {
  const Real kappa = ContactParams{}.kappa;
  const auto [light, heavy] = resting_heights(10 * kappa);
  EXPECT_NEAR(heavy, light, 1e-8);
  const auto [same, lower] = resting_heights(kappa);
  EXPECT_LT(lower, same - 1e-6);
}
