#include "tape/effects/body_inertia.inl"

#include <gtest/gtest.h>

#include <numbers>

#include "tape/effects/body_drive.inl"
#include "tests/support/derivatives.hpp"
#include "tests/support/effect_world.hpp"
using namespace tape;

// A body is many points: the energy must be the sum of m/2 |x - x_target|^2 over them, at any angle between pose and target.
TEST(BodyInertia, IsTheSumOverThePointsOfTheBody) {
  test::EffectWorld world(5);
  std::vector<Vec3> points;
  std::vector<Real> masses;
  Vec3 centre = Vec3::Zero();
  Real mass = 0;
  for (int k = 0; k < 30; ++k) {
    points.push_back(world.random_vector(0.02));
    masses.push_back(world.random(1e-4, 1e-3));
    mass += masses.back();
    centre += masses.back() * points.back();
  }
  Mat3 second = Mat3::Zero();
  for (std::size_t k = 0; k < points.size(); ++k) {
    points[k] -= centre / mass;
    second += masses[k] * points[k] * points[k].transpose();
  }
  const BodyQuadratic body{mass, second};
  for (Real angle : {0.0, 1e-6, 0.5, 3.14159}) {
    const Pose target{rotation_exp(world.random_vector(3)), world.random_vector(0.1)};
    const Pose at{rotation_exp(angle * world.random_vector(1).normalized()) * target.rotation, target.position + world.random_vector(1e-3)};
    Real energy = 0;
    Vec3 force = Vec3::Zero(), torque = Vec3::Zero();
    for (std::size_t k = 0; k < points.size(); ++k) {
      const Vec3 off = apply(at, points[k]) - apply(target, points[k]);
      energy += masses[k] / 2 * off.squaredNorm();
      force += masses[k] * off;
      torque += masses[k] * Vec3(at.rotation * points[k]).cross(off);
    }
    EXPECT_NEAR(body.energy(at, target), energy, 1e-13 * energy);
    const VecN<6> g = body.gradient(at, target);
    EXPECT_LT((g.head<3>() - force).norm(), 1e-14 * force.norm() + 1e-20) << angle;
    EXPECT_LT((g.tail<3>() - torque).norm(), 1e-12 * second.norm()) << angle;
  }
}
TEST(BodyInertia, HasTheHessianOfItsEnergyAtAnyAngle) {
  constexpr Real kPi = std::numbers::pi;
  test::EffectWorld world(8);
  const Mat3 any = Mat3::Random();
  const BodyQuadratic body{0.02, 1e-6 * any * any.transpose()};
  for (Real angle : {0.0, 1e-9, 1.0, kPi - 1e-9, kPi}) {
    const Pose target{rotation_exp(world.random_vector(3)), world.random_vector(0.1)};
    const Pose at{rotation_exp(angle * world.random_vector(1).normalized()) * target.rotation, target.position + world.random_vector(1e-3)};
    const auto gradient = [&](const Eigen::VectorXd& q) {
      return body.gradient({rotation_exp(Vec3(q.tail<3>())) * at.rotation, at.position + q.head<3>()}, target);
    };
    const Eigen::MatrixXd slope = test::jacobian(gradient, Eigen::VectorXd::Zero(6), 1e-4);
    const Eigen::MatrixXd h = body.hessian(at, target, HessianMode::exact);
    // Rotations do not commute: half the skew matrix of the torque is the slope's alone.
    EXPECT_LT((h - 0.5 * (slope + slope.transpose())).bottomRightCorner(3, 3).norm(), 1e-9 * body.second.norm()) << angle;
    EXPECT_LT((h - slope).topLeftCorner(3, 3).norm(), 1e-9 * body.mass) << angle;
  }
}
// A turn about an axis of inertia at which the curvature is cos(angle) of the inertia, which is 0 at 90 degrees: what is left must still
// take a step, and none that is longer than what bounds it allows.
TEST(BodyInertia, IsPositiveAndBoundsTheCurvatureWhenProjected) {
  test::EffectWorld world(9);
  const BodyQuadratic body{0.02, Vec3(1e-6, 2e-6, 5e-6).asDiagonal()};
  const Real least = 3e-6;  // the least of the moments of inertia, 1 + 2, 1 + 5 and 2 + 5
  for (Real degrees : {0.0, 60.0, 89.9, 90.0, 120.0, 180.0}) {
    const Real angle = degrees * std::numbers::pi / 180;
    for (const Vec3& axis :
         {Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0, 0, 1), Vec3(1, 1, 1).normalized(), world.random_vector(1).normalized()}) {
      const Pose target{rotation_exp(world.random_vector(3)), Vec3::Zero()};
      const Pose at{target.rotation * rotation_exp(angle * axis), Vec3::Zero()};
      const MatN<6, 6> projected = body.hessian(at, target, HessianMode::projected), exact = body.hessian(at, target, HessianMode::exact);
      EXPECT_GE(test::smallest_eigenvalue(projected), 0.1 * least * (1 - 1e-12)) << degrees << " about " << axis.transpose();
      EXPECT_GE(test::smallest_eigenvalue(projected - exact), -1e-12 * least) << degrees << " about " << axis.transpose();
    }
  }
}
TEST(BodyInertia, GoesWithTheInverseSquareOfTheTimeStep) {
  test::EffectWorld world(6);
  const test::Built<BodyInertia> built(world);
  const Real energy = built.term.energy(world.view(), 0);
  world.dt *= 0.5;
  EXPECT_NEAR(built.term.energy(world.view(), 0), 4 * energy, 1e-12 * energy);
}
TEST(BodyDrive, UnderAHundredNewtonsALinkLagsATenthOfAMicrometreAtMost) {
  test::EffectWorld world(7);
  const test::Built<BodyDrive> built(world);
  const BodyDrive::Element& e = built.elements[0];
  Real radius = 0;
  const BodyPart& part = world.assembly.bodies[static_cast<std::size_t>(e.body)];
  for (int v = part.first_vertex; v < part.first_vertex + part.vertices; ++v)
    radius = std::max(radius, world.assembly.local[static_cast<std::size_t>(v)].norm());
  world.body = world.body_target;
  const MatN<6, 6> h = built.term.hessian(world.view(), 0, HessianMode::exact);
  VecN<6> load;
  load << 100, 0, 0, 0, 0, 100 * radius;
  const VecN<6> lag = h.ldlt().solve(load);
  EXPECT_LE(lag.head<3>().norm(), 1.0000001e-7);
  EXPECT_LE(lag.tail<3>().norm() * radius, 1.0000001e-7);
}
