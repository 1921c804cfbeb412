#include "robot/model/inertia.hpp"

#include <gtest/gtest.h>

#include "robot/model/primitives.hpp"
using namespace robot;

namespace {
/// The definition: sum of m (|x - com|^2 I - (x - com)(x - com)^T) over point masses.
Inertial of_points(const std::vector<std::pair<Real, Vec3>>& points) {
  Inertial body;
  for (const auto& [m, x] : points) body.mass += m, body.com += m * x;
  body.com /= body.mass;
  for (const auto& [m, x] : points) {
    const Vec3 d = x - body.com;
    body.inertia += m * (d.squaredNorm() * Mat3::Identity() - d * d.transpose());
  }
  return body;
}

void expect_equal(const Inertial& a, const Inertial& b, Real tolerance) {
  EXPECT_NEAR(a.mass, b.mass, tolerance);
  EXPECT_LE((a.com - b.com).norm(), tolerance);
  EXPECT_LE((a.inertia - b.inertia).norm(), tolerance);
}

const std::vector<std::pair<Real, Vec3>> kFirst = {{1, {0, 0, 0}}, {2, {1, 0.5, 0}}, {0.5, {-0.3, 0.2, 0.7}}, {1.5, {0.1, -0.6, 0.4}}};
const std::vector<std::pair<Real, Vec3>> kSecond = {{3, {0.2, 0, 0.1}}, {1, {0, 0.5, -0.2}}, {0.7, {-0.4, 0.4, 0}}};
const Pose kPose = Eigen::Translation3d(0.3, -0.8, 0.5) * Eigen::AngleAxisd(0.9, Vec3(0.36, 0.48, 0.80));
}  // namespace

TEST(Inertia, MovingABodyMovesItsPoints) {
  auto points = kFirst;
  for (auto& [m, x] : points) x = kPose * x;
  expect_equal(moved(kPose, of_points(kFirst)), of_points(points), 1e-14);
}

TEST(Inertia, TwoBodiesAreTheBodyOfAllTheirPoints) {
  auto points = kFirst;
  points.insert(points.end(), kSecond.begin(), kSecond.end());
  expect_equal(combined(of_points(kFirst), of_points(kSecond)), of_points(points), 1e-14);
  expect_equal(combined(Inertial{}, of_points(kSecond)), of_points(kSecond), 0);
}

TEST(Inertia, ASolidBoxOffTheOriginHasTheTextbookInertia) {
  TriangleMesh mesh = box_shape({0.2, 0.3, 0.5}).mesh;
  for (Vec3& v : mesh.vertices) v += Vec3(1, -2, 0.5);
  const Inertial box = solid(mesh, 800);
  const Real m = 800 * 0.2 * 0.3 * 0.5;
  const Mat3 expected = m / 12 * Vec3(0.09 + 0.25, 0.04 + 0.25, 0.04 + 0.09).asDiagonal().toDenseMatrix();
  expect_equal(box, {m, {1, -2, 0.5}, expected}, 1e-12);
}

TEST(Inertia, PrincipalMomentsDoNotDependOnTheFrame) {
  const Vec3 moments(1, 2, 2.5);
  const Mat3 R = kPose.linear();
  EXPECT_LT((principal_moments(R * moments.asDiagonal() * R.transpose()) - moments).norm(), 1e-14);
}
