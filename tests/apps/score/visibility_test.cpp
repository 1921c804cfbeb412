#include "apps/score/visibility.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tape/math/rotation.hpp"
#include "tape/model/primitives.hpp"
using namespace tape;
using namespace tape::score;
using cosim::LandmarkKind;

namespace {
/// Looks along +z from the origin.
const render::Camera kCamera = render::Camera::make(cosim::Calibration{.fx = 600, .fy = 600, .cx = 424, .cy = 240}, {});
/// Half a metre ahead, turned out of the view by an angle about y.
Hub hub_turned(Real degrees, const Vec3& at = {0, 0, 0.5}) {
  return {{rotation_exp(Vec3(0, degrees * std::numbers::pi / 180, 0)), at}, 0.019, 0.02};
}
/// A plate across the view at 0.3 m that covers what lies right of x = `from` there.
TriangleMesh plate(Real from) {
  TriangleMesh mesh = sheet_mesh({1, 1}, {1, 1});
  for (Vec3& v : mesh.vertices) v += Vec3(from + 0.5, 0, 0.3);
  return mesh;
}
Obstacles bodies(const TriangleMesh& mesh) { return {mesh.vertices, {}, mesh.triangles}; }
Obstacles tapes(const TriangleMesh& mesh) { return {mesh.vertices, mesh.triangles, {}}; }
}  // namespace

TEST(Visibility, AHubBeforeTheCameraIsSeenWhole) {
  const Sight sight = sight_of(kCamera, hub_turned(30), {});
  EXPECT_EQ(sight.kind, LandmarkKind::rim);
  EXPECT_EQ(sight.share, 1);
}
TEST(Visibility, ATriangleBeforeItHidesWhatLiesBehindAndOneBehindItNothing) {
  EXPECT_EQ(sight_of(kCamera, hub_turned(0), bodies(plate(-0.5))).share, 0);
  // Face on the near rim lies at z = 0.49; at 0.3 m its middle is at x = 0: the plate hides one half.
  EXPECT_NEAR(sight_of(kCamera, hub_turned(0), bodies(plate(0))).share, 0.5, 0.03);
  // x = 0.019 * 0.3/0.49 * cos 60 deg: a third of the circle lies beyond.
  EXPECT_NEAR(sight_of(kCamera, hub_turned(0), bodies(plate(0.019 * 0.3 / 0.49 * 0.5))).share, 2. / 3, 0.03);
  TriangleMesh behind = plate(-0.5);
  for (Vec3& v : behind.vertices) v.z() += 0.3;
  EXPECT_EQ(sight_of(kCamera, hub_turned(0), bodies(behind)).share, 1);
  // Through the middle of a rim that leans by 30 degrees: its farther half is hidden.
  TriangleMesh through = plate(-0.5);
  for (Vec3& v : through.vertices) v.z() = 0.5 - 0.01 * std::sqrt(0.75);
  EXPECT_NEAR(sight_of(kCamera, hub_turned(30), bodies(through)).share, 0.5, 0.03);
}
TEST(Visibility, FromTheSideTheLandmarkIsTheMiddleOfTheCoreUnderItsTape) {
  const Sight side = sight_of(kCamera, hub_turned(90), tapes(plate(-0.5)));
  EXPECT_EQ(side.kind, LandmarkKind::side_box);
  EXPECT_EQ(side.share, 1) << "tape covers the core from the side anyway";
  EXPECT_EQ(sight_of(kCamera, hub_turned(90), bodies(plate(-0.5))).share, 0);
  EXPECT_EQ(sight_of(kCamera, hub_turned(30), tapes(plate(-0.5))).share, 0) << "but it hides a bore";
  // Beyond the plane of its end by 0.1 deg the rim of 46 px is 0.08 px wide: nobody can mark that.
  EXPECT_EQ(sight_of(kCamera, {{rotation_exp(Vec3(0, std::numbers::pi / 2, 0)), {0.0109, 0, 0.5}}, 0.019, 0.02}, {}).kind,
            LandmarkKind::side_box);
}
TEST(Visibility, WhatIsOutsideOfThePictureOrBehindTheCameraIsNotSeen) {
  EXPECT_EQ(sight_of(kCamera, hub_turned(0, {0.7, 0, 0.5}), {}).share, 0) << "424 + 600 * 0.7 / 0.49 px";
  EXPECT_NEAR(sight_of(kCamera, hub_turned(0, {0.49 * 423.5 / 600, 0, 0.5}), {}).share, 0.5, 0.03) << "half of it";
  EXPECT_EQ(sight_of(kCamera, hub_turned(0, {0, 0, -0.5}), {}).share, 0);
}
