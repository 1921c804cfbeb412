#include "robot/urdf/describe.hpp"

#include <gmock/gmock.h>

#include "tests/robot/urdf/robot_file.hpp"
using namespace robot;
using namespace robot::test;

namespace {
/// base -(spin at z 1)- arm -(slide by -0.5 to 0.2 at x 2)- cart, with a hook 0.3 m along y on the cart.
const std::string kRobot =
    link_text("base", R"(<visual><geometry><box size="1 1 1"/></geometry></visual>)") +
    link_text("arm", kBody + R"(<collision><geometry><sphere radius="0.1"/></geometry></collision>
      <collision><geometry><sphere radius="0.1"/></geometry></collision><collision><geometry><cylinder radius="1" length="1"/></geometry></collision>)") +
    link_text("cart") + link_text("hook", "") + link_text("pulley") +
    joint_text("spin", "continuous", "base", "arm",
               R"(<origin xyz="0 0 1"/><axis xyz="0 0 1"/><dynamics damping="0.5" friction="0.25"/>)") +
    joint_text("slide", "prismatic", "arm", "cart",
               R"(<origin xyz="2 0 0"/><limit lower="-0.5" upper="0.2" effort="10" velocity="0.1"/>)") +
    joint_text("screw", "fixed", "cart", "hook", R"(<origin xyz="0 0.3 0"/>)") +
    joint_text("belt", "revolute", "base", "pulley", kLimit + R"(<mimic joint="spin" multiplier="-2" offset="0.1"/>)");
}  // namespace

TEST(Describe, TheTextTellsWhatWasUnderstood) {
  EXPECT_EQ(describe(read_text(kRobot)),
            R"(robot r: links: 4, joints: 3 (1 of them mimic), frames of merged links: 1
link base: no mass, visual: 1 box
  joint spin: continuous about [0, 0, 1], -inf to inf rad, effort unlimited, velocity unlimited, damping 0.5 N m s/rad, friction 0.25 N m
  link arm: 1 kg, com [0, 0, 0] m, principal moments [0.001667, 0.001667, 0.001667] kg m^2, collision: 1 cylinder, 2 spheres
    joint slide: prismatic along [1, 0, 0], -0.5 to 0.2 m, effort 10 N, velocity 0.1 m/s
    link cart: 1 kg, com [0, 0, 0] m, principal moments [0.001667, 0.001667, 0.001667] kg m^2
      frame hook at [0, 0.3, 0] m
  joint belt: revolute about [1, 0, 0], -1 to 2 rad, effort 3 N m, velocity 4 rad/s, mimics -2 * spin + 0.1
  link pulley: 1 kg, com [0, 0, 0] m, principal moments [0.001667, 0.001667, 0.001667] kg m^2
mass: 3 kg in all
reach: hook is farthest from the base at q = 0, 2.256 m; no frame gets beyond 3.8 m, the length of the path to hook
pairs of links that may overlap: 3
note: taken as unlimited, because they are missing or 0: effort of spin, velocity of spin
note: joint spin has only -0.95 to 0.55 of its -inf to inf, by the limits of joints that follow it
)");
}

TEST(Describe, ReachIsTheDistanceAtZeroAndTheLengthOfTheLongestPath) {
  const Reach r = reach(read_text(kRobot));
  EXPECT_DOUBLE_EQ(r.at_zero, std::sqrt(1 + 4 + 0.09));
  EXPECT_DOUBLE_EQ(r.bound, 1 + 2 + 0.5 + 0.3);  // the cart slides farther back than forth
  EXPECT_EQ(r.farthest, "hook");
  EXPECT_EQ(r.longest_path, "hook");
}

TEST(Describe, AMimicJointStandsAtItsOffsetWhenTheOthersAreAtZero) {
  const std::string robot =
      link_text("a") + link_text("b") + link_text("c") + joint_text("lead", "revolute", "a", "b", kLimit) +
      joint_text("follow", "prismatic", "a", "c",
                 R"(<origin xyz="1 0 0"/><limit lower="0" upper="1" effort="1" velocity="1"/><mimic joint="lead" offset="0.5"/>)");
  EXPECT_DOUBLE_EQ(reach(read_text(robot)).at_zero, 1.5);
}
