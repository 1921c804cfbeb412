#include "tape/effects/seat.inl"

#include <gtest/gtest.h>

#include "tests/support/effect_world.hpp"
using namespace tape;

TEST(Seat, MovesNothingThatIsMovedAsAWhole) {
  for (unsigned seed : {1u, 2u, 3u}) {
    const test::EffectWorld world(seed);
    const test::Built<Seat> built(world);
    const VecN<12> g = built.term.gradient(world.view(), 0);
    const Vec3 hub = world.body[1].position, cluster = world.body[0].position;
    EXPECT_LE((g.segment<3>(0) + g.segment<3>(6)).norm(), 1e-14 * g.norm());
    const Vec3 torque = g.segment<3>(3) + g.segment<3>(9) + hub.cross(Vec3(g.segment<3>(0))) + cluster.cross(Vec3(g.segment<3>(6)));
    EXPECT_LE(torque.norm(), 1e-14 * g.norm());
  }
}
TEST(Seat, IsItsFormWhereTheBodiesAreAsTheyWereAndTheHubStandsTurned) {
  test::EffectWorld world(4);
  Seat::Element& seat = world.seats[0];
  // The cluster where the form is at, and from there moved by xi in the hub's axes about its foot.
  VecN<6> xi;
  xi << 1e-4, -2e-4, 3e-4, 0, 0, 0;
  const Pose& hub = world.body[1];
  const Mat3 R = hub.rotation * seat.turn;
  world.body[0] = {R, hub.position - R * seat.arm + hub.rotation * xi.head<3>()};
  const test::Built<Seat> moved(world);
  const PlaceForm& form = seat.form;
  EXPECT_NEAR(moved.term.energy(world.view(), 0), form.energy + form.force.dot(xi) + xi.dot(form.stiffness * xi) / 2, 1e-12);
  const Vec3 force = hub.rotation * (form.force + form.stiffness * xi).head<3>();
  EXPECT_LE((Vec3(moved.term.gradient(world.view(), 0).segment<3>(6)) - force).norm(), 1e-9 * force.norm());
}
TEST(PlaceForm, SeenFromTurnedAxesHasTheSameEnergy) {
  test::EffectWorld world(5);
  const PlaceForm form = world.seats[0].form;
  const Mat3 R = rotation_exp(world.random_vector(2));
  const PlaceForm seen = form.seen_from(R);
  VecN<6> xi, turned;
  xi << world.random_vector(1), world.random_vector(1);
  turned << R.transpose() * xi.head<3>(), R.transpose() * xi.tail<3>();
  EXPECT_NEAR(seen.force.dot(turned), form.force.dot(xi), 1e-12);
  EXPECT_NEAR(turned.dot(seen.stiffness * turned), xi.dot(form.stiffness * xi), 1e-9);
}
