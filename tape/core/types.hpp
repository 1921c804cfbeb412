#pragma once
#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstdint>
#include <type_traits>

#include "tape/core/hd.hpp"

namespace tape {
using Real = double;
using Vec2 = Eigen::Matrix<Real, 2, 1>;
using Vec3 = Eigen::Matrix<Real, 3, 1>;
using Mat2 = Eigen::Matrix<Real, 2, 2>;
using Mat3 = Eigen::Matrix<Real, 3, 3>;
using Mat32 = Eigen::Matrix<Real, 3, 2>;
template <int N>
using VecN = Eigen::Matrix<Real, N, 1>;
template <int R, int C>
using MatN = Eigen::Matrix<Real, R, C>;
using Index3 = Eigen::Vector3i;
using Index2 = Eigen::Vector2i;

/// Pose of frame B in the world W: x_W = rotation * x_B + position [m].
struct Pose {
  Mat3 rotation = Mat3::Identity();
  Vec3 position = Vec3::Zero();
};
TAPE_HD inline Vec3 apply(const Pose& X_WB, const Vec3& p_B) { return X_WB.rotation * p_B + X_WB.position; }

/// `exact` keeps negative curvature; `projected` is positive semidefinite in closed form (effects/README.md).
enum class HessianMode { exact, projected };

/// What a kernel sees of an array: pointer and length, memory of the side that runs the kernel.
template <class T>
struct Span {
  T* data = nullptr;
  int size = 0;
  TAPE_HD T& operator[](int i) const { return data[i]; }
  TAPE_HD T* begin() const { return data; }
  TAPE_HD T* end() const { return data + size; }
  template <class U>
  requires(std::is_same_v<U, const T> && !std::is_const_v<T>) TAPE_HD operator Span<U>() const { return {data, size}; }
};
}  // namespace tape
