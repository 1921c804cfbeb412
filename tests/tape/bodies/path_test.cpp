#include "tape/bodies/path.hpp"

#include <gtest/gtest.h>

using namespace tape;

namespace {
/// A vertex that rides a body, whose two blocks come first.
struct Rider {
  Pose body{rotation_exp(Vec3(0.1, 0.2, -0.3)), Vec3(0.3, -0.1, 0.2)};
  Vec3 x = body.position + Vec3(0.02, 0.01, -0.003);
  VertexOwner owner{.block = 2, .body = -1, .ride = 0, .ride_block = 0};
  Vec3 direction[3] = {Vec3(1e-3, 2e-3, -1e-3), Vec3(0.05, -0.02, 0.2), Vec3::Zero()};
  Vec3 arm() const { return x - body.position; }
  /// Moves of the body where the vertex is, to first order.
  Vec3 along() const { return direction[0] + direction[1].cross(arm()); }
  VertexPath path() const { return PathView{{&x, 1}, {&owner, 1}, {direction, 3}, {&body, 1}}[0]; }
};
}  // namespace

TEST(VertexPath, WhatGoesWithItsBodyKeepsItsPlaceOnIt) {
  Rider rider;
  rider.direction[2] = rider.along();
  for (Real t : {0.25, 0.5, 1.0}) {
    const Vec3 centre = rider.body.position + t * rider.direction[0], carried = centre + rotate(t * rider.direction[1], rider.arm());
    EXPECT_LT((rider.path().at(t) - carried).norm(), 1e-16) << t;
  }
}
TEST(VertexPath, ARiderSetsOutAsItsOwnDirectionSays) {
  Rider rider;
  for (Real apart : {0.0, 0.1, 0.5, 0.9, 0.99, 1.5}) {
    rider.direction[2] = rider.along() + apart * rider.direction[1].cross(rider.arm()).norm() * Vec3(0.6, 0, 0.8);
    const VertexPath path = rider.path();
    const Real h = 1e-5;
    EXPECT_LT(((path.at(h) - path.at(-h)) / (2 * h) - rider.direction[2]).norm(), 1e-10) << apart;
    EXPECT_LT((path.at(0) - rider.x).norm(), 1e-16) << apart;
    EXPECT_EQ(path.straight(), apart > 1) << apart;
  }
}
TEST(VertexPath, APartOfARidersStepIsTheStepOfAPartOfTheDirection) {
  Rider rider;
  rider.direction[2] = rider.along() + Vec3(1e-3, -5e-4, 0);
  const VertexPath whole = rider.path();
  for (Vec3& d : rider.direction) d *= 0.3;
  EXPECT_LT((rider.path().at(1) - whole.at(0.3)).norm(), 1e-16);
}
