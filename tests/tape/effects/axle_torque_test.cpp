#include "tape/effects/axle_torque.inl"

#include <gtest/gtest.h>

#include "tape/math/rotation.hpp"
#include "tests/support/derivatives.hpp"
#include "tests/support/effect_world.hpp"
using namespace tape;

namespace {
/// An axle about z through the origin: an arm of 10 mm that turns over dials at rest, by 0.5 rad more since the step of 10 ms started.
struct Turned {
  Real torque = 0.2, speed = 0;
  Real by = 0.5;
  StateView view() {
    elements = {{{0, 1, 2, 3, 4}, torque, speed}};
    term = {{elements.data(), 1}, 1e-2};
    const auto at = [](Real angle) { return Vec3(0.01 * std::cos(angle), 0.01 * std::sin(angle), 0); };
    start = {Vec3::Zero(), at(3), Vec3::Zero(), at(0), at(0.5 * 3.14159265358979312)};
    x = start;
    x[1] = at(3 + by);
    StateView s{};
    s.dt = 0.01;
    s.x = {x.data(), 5}, s.x_start = {start.data(), 5};
    return s;
  }
  std::vector<AxleTorque::Element> elements = {};
  AxleTorque term{};
  std::vector<Vec3> x = {}, start = {};
};
}  // namespace

TEST(AxleTorque, IsTheWholeTorqueAgainstTurningAndAgainstWhatIsLeftBehindADrive) {
  Turned free;
  EXPECT_NEAR(free.term.slip(free.view(), 0), 0.5, 1e-12) << "also across the half turn where the angle jumps";
  EXPECT_NEAR(free.term.torque(free.view(), 0), -0.2, 1e-15);
  EXPECT_NEAR(free.term.energy(free.view(), 0), 0.2 * 0.5, 1e-15);
  Turned driven{.speed = 80};
  EXPECT_NEAR(driven.term.slip(driven.view(), 0), 0.5 - 0.8, 1e-12);
  EXPECT_NEAR(driven.term.torque(driven.view(), 0), 0.2, 1e-15);
  Turned back{.by = -0.25};
  EXPECT_NEAR(back.term.torque(back.view(), 0), 0.2, 1e-15);
}
TEST(AxleTorque, SticksBelowItsCreep) {
  Turned slow{.by = 5e-5};  // half of creep dt: f0' = 2 y/eps - (y/eps)^2 = 3/4
  EXPECT_NEAR(slow.term.torque(slow.view(), 0), -0.75 * 0.2, 1e-11);
}
TEST(AxleTorque, HasTheDerivativesOfItsEnergyWhileItSticks) {
  for (unsigned seed : {1u, 2u, 3u}) {
    const test::EffectWorld world(seed);
    const test::Built<AxleTorque> built(world, {.creep = 20});  // 0.2 rad a step: more than it slips
    for (int i = 0; i < built.count(); ++i) {
      const test::Element<AxleTorque> e(world, built.term, i);
      const Eigen::VectorXd g = e.gradient(e.rest());
      EXPECT_LE((g - test::slope([&](const Eigen::VectorXd& q) { return e.energy(q); }, e.rest(), 1e-6)).norm(), 1e-6 * g.norm());
      const Eigen::MatrixXd h = e.hessian(HessianMode::exact);
      EXPECT_LE((h - test::jacobian([&](const Eigen::VectorXd& q) { return e.gradient(q); }, e.rest(), 1e-6)).norm(), 1e-6 * h.norm());
    }
  }
}
