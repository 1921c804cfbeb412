#include "robot/model/inertia.hpp"

#include <Eigen/Eigenvalues>

namespace robot {
namespace {
/// Of a point of unit mass at d, about the origin.
Mat3 point_inertia(const Vec3& d) { return d.squaredNorm() * Mat3::Identity() - d * d.transpose(); }
}  // namespace

Inertial moved(const Pose& X_AB, const Inertial& body) {
  const Mat3 R = X_AB.linear();
  return {body.mass, X_AB * body.com, R * body.inertia * R.transpose()};
}

Inertial combined(const Inertial& a, const Inertial& b) {
  if (a.mass == 0) return b;
  if (b.mass == 0) return a;
  const Real mass = a.mass + b.mass;
  const Vec3 com = (a.mass * a.com + b.mass * b.com) / mass;
  return {mass, com, a.inertia + a.mass * point_inertia(a.com - com) + b.inertia + b.mass * point_inertia(b.com - com)};
}

Inertial solid(const TriangleMesh& mesh, Real density) {
  Real volume = 0;
  Vec3 first = Vec3::Zero();
  Mat3 second = Mat3::Zero();
  for (const auto& [i, j, k] : mesh.triangles) {  // tetrahedra with the origin
    const Vec3 &a = mesh.vertices[i], &b = mesh.vertices[j], &c = mesh.vertices[k], sum = a + b + c;
    const Real det = a.dot(b.cross(c));
    volume += det / 6;
    first += det / 24 * sum;
    second += det / 120 * (sum * sum.transpose() + a * a.transpose() + b * b.transpose() + c * c.transpose());
  }
  const Vec3 com = first / volume;
  const Mat3 central = second - volume * com * com.transpose();
  return {density * volume, com, density * (central.trace() * Mat3::Identity() - central)};
}

Vec3 principal_moments(const Mat3& inertia) { return Eigen::SelfAdjointEigenSolver<Mat3>(inertia, Eigen::EigenvaluesOnly).eigenvalues(); }
}  // namespace robot
