#include "tape/model/roll.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "tape/bodies/assembly.hpp"
#include "tape/math/rotation.hpp"
#include "tape/model/mesh_check.hpp"
#include "tape/model/strip_mesh.hpp"
#include "tests/support/simulation.hpp"
using namespace tape;

namespace {
constexpr Real kPi = std::numbers::pi;
struct Roll {
  Scene scene;
  StripMesh mesh;
  std::vector<Vec3> x;  // of the strip
  const Strip& strip() const { return scene.strips[0]; }
  const Body& hub() const { return scene.bodies[0]; }
  std::vector<Vec3> hub_vertices() const {
    std::vector<Vec3> placed;
    for (const Vec3& v : hub().mesh.vertices) placed.push_back(apply(hub().pose, v));
    return placed;
  }
};
Roll make_roll(const WindingParams& params, const Pose& pose = {}, const Core& core = {}) {
  Roll roll;
  roll.scene.films = {test::vinyl()};
  Strip strip;
  wind(roll.scene, strip, params, core, pose);
  roll.scene.strips = {strip};
  roll.mesh = make_strip_mesh(strip.mesh, test::vinyl().width, 1);
  roll.x = place(roll.mesh, strip);
  return roll;
}
/// [1/m] of dx/r^2 over the spiral: pitch/(2 pi) sets its slope.
Real integral_of_inverse_square(const Winding& w) { return 2 * kPi / w.pitch * std::log(w.outer_radius() / w.radius); }
Real radius(const Vec3& x) { return std::hypot(x.x(), x.z()); }
Vec3 mirrored(const Vec3& x) { return {-x.x(), x.y(), x.z()}; }
}  // namespace

TEST(Roll, IsAsLongAsWhatIsWoundAndWhatIsFree) {
  const Roll roll = make_roll({.turns = 8, .free_length = 0.06});
  EXPECT_NEAR(roll.strip().mesh.length, roll.strip().winding->wound() + 0.06, 1e-15);
  EXPECT_EQ(roll.mesh.columns, 7);
  EXPECT_EQ(roll.mesh.rows, 1 + static_cast<int>(std::round(roll.strip().mesh.length / (0.019 / 6)))) << "square cells";
}

TEST(Roll, ChordsBetweenItsRowsAreAsLongAsAtRest) {
  const Roll roll = make_roll({.turns = 8, .free_length = 0.02});
  const Winding& w = *roll.strip().winding;
  const Real cell = cell_length(roll.strip().mesh, 0.019);
  int rows = 0;
  for (int i = 0; (i + 1) * cell < w.wound(); ++i, ++rows) {
    const Real a = w.angle(i * cell), b = w.angle((i + 1) * cell), left = 2 * kPi - std::fmod(a, 2 * kPi);
    const bool bends = left < b - a || (left > w.climb && left - (b - a) < w.climb);  // into or out of a climb
    // The mean radius of a turn is pitch/2 off at most: of (cell/2 r)^2/6 that is pitch/r. A kink of pitch/(climb r) adds up to a quarter
    // of its product with the turning cell/r of the cell.
    const Real turning = cell / w.radius, kink = bends ? w.pitch / (w.climb * w.radius) * turning / 4 : 0;
    const Real tolerance = turning * turning / 24 * 2 * w.pitch / w.radius + kink;
    EXPECT_NEAR((roll.x[(i + 1) * 7] - roll.x[i * 7]).norm(), cell, tolerance * cell) << i << "; rows at equal arc length: 9e-4 shorter";
  }
  EXPECT_GT(rows, 300);
}

TEST(Roll, EachTurnLiesAtItsRadiusAndClimbsOverTheStartOfTheTape) {
  const Roll roll = make_roll({.turns = 3, .free_length = 0.02});
  const Winding& w = *roll.strip().winding;
  const Real cell = cell_length(roll.strip().mesh, 0.019);
  int flat = 0, climbing = 0;
  for (int i = 0; i * cell < w.wound(); ++i) {
    const Real theta = w.angle(i * cell), k = std::floor(theta / (2 * kPi)), left = 2 * kPi * (k + 1) - theta;
    const Real expected = w.radius + w.pitch * (left > w.climb ? k : k + 1 - left / w.climb);
    EXPECT_NEAR(radius(roll.x[i * 7]), expected, 1e-15) << i;
    ++(left > w.climb ? flat : climbing);
  }
  EXPECT_GT(flat, 100);
  EXPECT_GT(climbing, 5);
  const Real lost = integral_of_inverse_square(w) * w.cell * w.cell / 24;
  EXPECT_NEAR(w.length() - w.wound(), lost, 2e-3 * lost);
}

TEST(Roll, EverySectionIsStraightParallelToTheAxisAndOnTheHub) {
  const Roll roll = make_roll({.turns = 2});
  const Real half_core = 0.010;
  for (std::size_t v = 0; v < roll.x.size(); ++v) {
    const Vec3 along = roll.x[v] - roll.x[v / 7 * 7];
    EXPECT_LT(along.cwiseAbs().x() + along.cwiseAbs().z(), 1e-16);
    EXPECT_NEAR(std::fabs(along.y()), 0.019 * static_cast<Real>(v % 7) / 6, 1e-16);
    EXPECT_LT(std::fabs(roll.x[v].y()), half_core);
  }
}

TEST(Roll, BackingLooksOutwardsAndTheFreeEndLeavesTheTopToItsSide) {
  for (Sense sense : {Sense::left, Sense::right}) {
    const Roll roll = make_roll({.turns = 2.4, .free_length = 0.05, .sense = sense});
    const Real wound = roll.strip().winding->wound(), side = sense == Sense::right ? 1 : -1;
    for (const Index3& t : roll.mesh.triangles) {
      const Vec3 &a = roll.x[t[0]], &b = roll.x[t[1]], &c = roll.x[t[2]], n = (b - a).cross(c - a).normalized();
      if (std::max({roll.mesh.rest[t[0]].x(), roll.mesh.rest[t[1]].x(), roll.mesh.rest[t[2]].x()}) < wound) {
        EXPECT_GT(n.dot(Vec3(a.x() + b.x() + c.x(), 0, a.z() + b.z() + c.z()).normalized()), 0.99);
      }
    }
    const Real top = roll.strip().winding->outer_radius();
    EXPECT_NEAR(roll.x.back().x(), side * 0.05, 1e-4) << to_text(sense);
    EXPECT_NEAR(roll.x.back().z(), top, 1e-7) << to_text(sense);
  }
}

TEST(Roll, BothSensesAreMirrorImagesByAProperRotation) {
  const WindingParams params{.turns = 2.4, .free_length = 0.05};
  WindingParams other = params;
  other.sense = Sense::right;
  const Roll left = make_roll(params), right = make_roll(other);
  EXPECT_EQ(left.strip().pose.rotation.determinant(), 1);
  EXPECT_EQ(left.hub().pose.rotation.determinant(), 1);
  EXPECT_EQ(left.mesh.triangles, right.mesh.triangles);
  for (int row = 0; row < left.mesh.rows; ++row)
    for (int j = 0; j < 7; ++j) EXPECT_LT((mirrored(left.x[row * 7 + j]) - right.x[row * 7 + 6 - j]).norm(), 1e-15);
  for (const Vec3& v : left.hub_vertices()) {
    const std::vector<Vec3> all = right.hub_vertices();
    EXPECT_TRUE(std::any_of(all.begin(), all.end(), [&](const Vec3& w) { return (w - mirrored(v)).norm() < 1e-15; })) << v.transpose();
  }
}

TEST(Roll, StandsWhereItsPoseIs) {
  const Pose pose{rotation_exp({0.4, -1.1, 0.6}), {1, -2, 3}};
  const Roll here = make_roll({.turns = 1.5}), there = make_roll({.turns = 1.5}, pose);
  for (std::size_t v = 0; v < here.x.size(); ++v) EXPECT_LT((apply(pose, here.x[v]) - there.x[v]).norm(), 1e-14);
  for (std::size_t v = 0; v < here.hub_vertices().size(); ++v)
    EXPECT_LT((apply(pose, here.hub_vertices()[v]) - there.hub_vertices()[v]).norm(), 1e-14);
}

TEST(Roll, HubIsAClosedRingWhoseMassAndInertiaAreThoseOfTheAnnulus) {
  const Roll roll = make_roll({.turns = 1});
  EXPECT_EQ(roll.hub().name, "hub");
  EXPECT_EQ(roll.strip().winding->hub, 0);
  EXPECT_EQ(roll.hub().xi, 0);
  EXPECT_NO_THROW(check_mesh(roll.hub().mesh, "hub", true));
  for (const Vec3& v : roll.hub_vertices()) {
    EXPECT_TRUE(std::fabs(radius(v) - 0.019) < 1e-15 || std::fabs(radius(v) - 0.0211) < 1e-15);
    EXPECT_NEAR(std::fabs(v.y()), 0.010, 1e-16);
  }
  const Assembly a = assemble(roll.scene);
  const BodyPart& hub = a.bodies[0];
  const Real inner2 = 0.019 * 0.019, outer2 = 0.0211 * 0.0211, mass = kPi * (outer2 - inner2) * 0.020 * 950;
  EXPECT_NEAR(hub.mass.mass, mass, 1e-12 * mass);
  const Mat3 inertia = hub.start.rotation * (hub.mass.second.trace() * Mat3::Identity() - hub.mass.second) * hub.start.rotation.transpose();
  const Real about = mass * (inner2 + outer2) / 2, across = mass * (3 * (inner2 + outer2) + 0.020 * 0.020) / 12;
  EXPECT_LT((inertia - Vec3(across, about, across).asDiagonal().toDenseMatrix()).norm(), 1e-12 * about);
  EXPECT_LT(hub.start.position.norm(), 1e-18);
}

TEST(Roll, AMassGivenForABodyWithASolidScalesItsInertia) {
  Roll roll = make_roll({.turns = 1});
  const Mat3 before = assemble(roll.scene).bodies[0].mass.second;
  roll.scene.bodies[0].mass = 2 * assemble(roll.scene).bodies[0].mass.mass;
  EXPECT_LT((assemble(roll.scene).bodies[0].mass.second - 2 * before).norm(), 1e-14 * before.norm());
}

TEST(Roll, ACoreWithoutAWallIsRefused) {
  try {
    make_roll({}, {}, {.inner_diameter = 0.0422});
    ADD_FAILURE() << "accepted";
  } catch (const InputError& e) {
    EXPECT_NE(std::string(e.what()).find("roll.core.inner_diameter = 0.0422"), std::string::npos) << e.what();
  }
}
