#include "tape/bodies/path.hpp"

#include <gtest/gtest.h>

#include "tape/bodies/configuration.hpp"

using namespace tape;
using namespace tape::on_cpu;

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

namespace {
/// Two bodies, of which the second rides the first, each with its centre and a point, on a step of 0.3 rad.
struct Ridden {
  Pose body[2]{{rotation_exp(Vec3(0.1, 0.2, -0.3)), Vec3(0.3, -0.1, 0.2)}, {rotation_exp(Vec3(-1, 0.4, 0)), Vec3(0.301, -0.102, 0.203)}};
  Vec3 local[4]{Vec3::Zero(), Vec3(0.02, 0.01, -0.003), Vec3::Zero(), Vec3(-0.01, 0.02, 0.004)};
  Vec3 direction[4]{Vec3(1e-3, 2e-3, -1e-3), Vec3(0.1, -0.05, 0.28), Vec3::Zero(), Vec3::Zero()};
  Coordinates coordinates{{{0, 0}, {0, 0}, {2, 1, 0, 0}, {2, 1, 0, 0}}, {local, local + 4}, {0, 2}, {0, 2}, 4};
  Configuration from, to;
  Ridden() {
    std::vector<Vec3> x;
    for (int v = 0; v < 4; ++v) x.push_back(apply(body[v / 2], local[v]));
    from.x.upload(x), from.body.upload({body, body + 2});
    to.copy_from(from);
  }
  Buffer<Vec3> unknowns() const { return Buffer<Vec3>(std::vector<Vec3>(direction, direction + 4)); }
};
}  // namespace

TEST(Coordinates, TwoBodiesThatTurnAsOneKeepTheirPlacesToEachOther) {
  Ridden r;
  r.direction[2] = r.direction[0] + r.direction[1].cross(r.body[1].position - r.body[0].position);
  r.direction[3] = r.direction[1];
  const Buffer<Vec3> direction = r.unknowns();
  for (Real t : {0.25, 0.5, 1.0}) {
    r.coordinates.move(r.from, direction.span(), t, r.to);
    const std::vector<Pose> now = r.to.body.download();
    const auto seen = [](const Pose& a, const Pose& b) { return Vec3(a.rotation.transpose() * (b.position - a.position)); };
    EXPECT_LT((seen(now[0], now[1]) - seen(r.body[0], r.body[1])).norm(), 1e-15) << t << ", on straight ways 2e-4 m";
  }
}
TEST(Coordinates, ABodyThatRidesSetsOutAsItsOwnDirectionSaysAndStaysRigid) {
  Ridden r;
  r.direction[2] = Vec3(-2e-3, 1e-3, 3e-3), r.direction[3] = Vec3(0.2, 0.3, -0.1);
  const Buffer<Vec3> direction = r.unknowns();
  const PathView paths = r.coordinates.paths(r.from, direction.span());
  const Real h = 1e-5;
  for (int v : {2, 3}) {
    const Vec3 speed = r.direction[2] + r.direction[3].cross(paths.x[v] - r.body[1].position);
    EXPECT_LT(((paths[v].at(h) - paths[v].at(-h)) / (2 * h) - speed).norm(), 1e-10) << v;
  }
  r.coordinates.move(r.from, direction.span(), 0.7, r.to);
  const Pose now = r.to.body.download()[1];
  for (int v : {2, 3}) {
    EXPECT_LT((r.to.x.download()[static_cast<std::size_t>(v)] - apply(now, r.local[v])).norm(), 1e-15) << v;
    EXPECT_LT((paths[v].at(0.7) - apply(now, r.local[v])).norm(), 1e-15) << v << ", as CCD sees it";
  }
}
