#include "tape/effects/tether.inl"

#include <gtest/gtest.h>

#include "tests/support/effect_world.hpp"
using namespace tape;

TEST(Tether, PullsToItsTargetOrItsAnchorAndAnOpenOneNot) {
  test::EffectWorld world(1);
  const test::Built<Tether> built(world);
  ASSERT_EQ(built.count(), 3);  // two points to targets, the second open; one to an anchor
  const StateView s = world.view();
  EXPECT_EQ(built.term.pull(s, 0), Vec3(100 * (world.x[0] - world.grip_target[0])));
  EXPECT_TRUE(built.term.active(s, 0));
  EXPECT_FALSE(built.term.active(s, 1));
  EXPECT_EQ(built.term.energy(s, 1), 0);
  const int anchor = world.assembly.grips[1].anchors[0];
  EXPECT_EQ(built.term.pull(s, 2), Vec3(50 * (world.x[2] - world.x[static_cast<std::size_t>(anchor)])));
  const VecN<6> g = built.term.gradient(s, 2);
  EXPECT_EQ(g.head<3>(), -g.tail<3>());
}
