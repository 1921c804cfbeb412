#include "tape/bodies/free_flight.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "tape/math/rotation.hpp"

namespace tape {
namespace {
/// exp-like map that keeps angular momentum with the midpoint rule: (I - W/2)^-1 (I + W/2), W = skew(w).
Mat3 cayley(const Vec3& w) {
  const Mat3 half = 0.5 * skew(w);
  return (Mat3::Identity() - half).inverse() * (Mat3::Identity() + half);
}
}  // namespace

Mat3 free_flight(const Mat3& R, const Vec3& L, const Mat3& second, Real dt) {
  const Mat3 inverse_inertia = inertia_tensor(second).inverse();
  Vec3 momentum = R.transpose() * L;  // in the body
  const Real angle = dt * (inverse_inertia * momentum).norm();
  const int substeps = std::clamp(static_cast<int>(std::ceil(angle / 0.05)), 1, 1000);
  const Real h = dt / substeps;
  Mat3 rotation = R;
  for (int k = 0; k < substeps; ++k) {
    Vec3 spin = inverse_inertia * momentum, next = momentum;
    for (int i = 0; i < 100; ++i) {  // fixed point of next = cayley(-h spin) momentum: contracts by about |h spin| / 2
      const Vec3 before = next;
      next = cayley(-h * spin) * momentum;
      spin = inverse_inertia * (0.5 * (momentum + next));
      if ((next - before).norm() <= 1e-16 * momentum.norm()) break;
    }
    rotation = rotation * cayley(h * spin);
    momentum = rotation.transpose() * L;
  }
  return rotation;
}
}  // namespace tape
