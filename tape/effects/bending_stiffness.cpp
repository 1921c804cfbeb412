#include "tape/effects/bending_stiffness.hpp"

#include <Eigen/LU>
#include <cmath>

#include "tape/math/psd.hpp"

namespace tape {
namespace {
/// Symmetric 2x2 matrices as vectors (xx, yy, sqrt2 xy), so that the scalar product is that of matrices.
Vec3 product(const Vec2& u, const Vec2& v) { return {u.x() * v.x(), u.y() * v.y(), (u.x() * v.y() + u.y() * v.x()) / std::sqrt(2.0)}; }

/// Row r with r.S = angle at edge k where the surface has the uniform curvature S. The apex stands off the triangle's plane by
/// -1/2 sum_(i<j) beta_i beta_j e_ij^T S e_ij, beta its barycentric coordinates.
Vec3 angle_of_curvature(const FlatTriangle& t, int k) {
  Vec3 sum = Vec3::Zero();
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3;
    const Real beta_i = t.depth(i, t.apex[k]) / t.depth(i, t.X[i]), beta_j = t.depth(j, t.apex[k]) / t.depth(j, t.X[j]);
    sum -= 0.5 * beta_i * beta_j * product(t.X[j] - t.X[i], t.X[j] - t.X[i]);
  }
  return sum / -t.depth(k, t.apex[k]);
}

using Small = Eigen::Matrix<Real, Eigen::Dynamic, Eigen::Dynamic, 0, 3, 3>;

/// K of one triangle as an affine function of the moments that its edges exchange: K = own + U from_angles, where row i of U is
/// side l xi of inner edge i and xi [3] belongs to the edge.
struct Stencil {
  std::vector<int> inner;
  Small own;          ///< [m x m]
  Small from_angles;  ///< [3 x m] curvature of given angles
  Small wanted;       ///< [m x m] the stiffness of the mean normals
};

/// Curvatures [3 x m] that leave the free edges without moment.
Small admissible_curvatures(const FlatTriangle& t, const std::vector<int>& inner) {
  if (inner.size() == 3) return Small(Mat3::Identity());
  Vec3 free[2];
  int count = 0;
  Vec2 normal;
  for (int k = 0; k < 3; ++k) {
    if (t.inner[k]) continue;
    normal = t.normal(k);
    free[count++] = product(normal, normal);
  }
  if (count == 2) return Small(free[0].cross(free[1]).normalized());
  const Vec2 tangent(-normal.y(), normal.x());
  Small basis(3, 2);
  basis << product(tangent, tangent), std::sqrt(2.0) * product(normal, tangent);
  return basis;
}

Stencil make_stencil(const FlatTriangle& t) {
  Stencil s;
  for (int k = 0; k < 3; ++k)
    if (t.inner[k]) s.inner.push_back(k);
  const int m = static_cast<int>(s.inner.size());
  if (m == 0) return s;
  const Small basis = admissible_curvatures(t, s.inner);
  const Mat3 mean = mean_normal_stiffness(t);
  Small angles(m, m), moments(m, m);
  s.wanted.resize(m, m);
  for (int i = 0; i < m; ++i) {
    const int k = s.inner[static_cast<std::size_t>(i)];
    angles.row(i) = angle_of_curvature(t, k).transpose() * basis;
    moments.row(i) = t.length(k) / 2 * product(t.normal(k), t.normal(k)).transpose() * basis;
    for (int j = 0; j < m; ++j) s.wanted(i, j) = mean(k, s.inner[static_cast<std::size_t>(j)]);
  }
  constexpr Real kDegenerate = 1e-3;  // the six points lie on a conic: their heights do not tell the curvature
  if (std::fabs(Small(angles / std::sqrt(t.area())).determinant()) < kDegenerate) {
    s.own = s.wanted;
    s.from_angles = Small::Zero(3, m);
  } else {
    const Small inverse = angles.inverse();
    s.own = moments * inverse;
    s.from_angles = basis * inverse;
  }
  return s;
}

/// Least squares for the exchanges: the stiffness be symmetric, and with a smaller weight close to that of the mean normals,
/// which keeps it positive. Conjugate gradients on the normal equations; everything in fixed order.
class Exchange {
 public:
  Exchange(const std::vector<FlatTriangle>& mesh, int edges) : mesh_(mesh), xi_(static_cast<std::size_t>(edges), Vec3::Zero()) {
    for (const FlatTriangle& t : mesh) stencils_.push_back(make_stencil(t));
  }
  void solve() {
    constexpr int kIterations = 1000;
    constexpr Real kTolerance = 1e-16;  // of the squared gradient
    std::vector<Small> residual;
    for (const Stencil& s : stencils_) residual.push_back(weigh(s.wanted - s.own));
    std::vector<Vec3> gradient = pull_back(residual), direction = gradient;
    const Real start = squared(gradient);
    Real now = start;
    for (int i = 0; i < kIterations && now > kTolerance * start; ++i) {
      std::vector<Small> change;
      Real change2 = 0;
      for (std::size_t t = 0; t < stencils_.size(); ++t) {
        change.push_back(weigh(exchanged(t, direction)));
        change2 += change.back().squaredNorm();
      }
      const Real step = now / change2;
      for (std::size_t e = 0; e < xi_.size(); ++e) xi_[e] += step * direction[e];
      for (std::size_t t = 0; t < stencils_.size(); ++t) residual[t] -= step * change[t];
      gradient = pull_back(residual);
      const Real next = squared(gradient);
      for (std::size_t e = 0; e < xi_.size(); ++e) direction[e] = gradient[e] + next / now * direction[e];
      now = next;
    }
  }
  Mat3 stiffness(std::size_t t) const {
    constexpr Real kMeanShare = 0.02;  // on crossed meshes a wrinkle of the cell centres has next to no energy without
    const Stencil& s = stencils_[t];
    const int m = static_cast<int>(s.inner.size());
    Mat3 K = Mat3::Zero();
    if (m == 0) return K;
    const Small own = s.own + exchanged(t, xi_);
    for (int i = 0; i < m; ++i)
      for (int j = 0; j < m; ++j)
        K(s.inner[static_cast<std::size_t>(i)], s.inner[static_cast<std::size_t>(j)]) = (own(i, j) + own(j, i)) / 2;
    K = (1 - kMeanShare) * psd_part(K) + kMeanShare * mean_normal_stiffness(mesh_[t]);
    return 0.5 * (K + K.transpose());
  }

 private:
  static constexpr Real kClose = 0.3;  // weight of staying close to the mean normals
  /// Entries of Z + Z^T (diagonal and above) and Z - Z^T (below), weighted.
  static Small weigh(const Small& Z) {
    Small r = Z;
    for (Eigen::Index i = 0; i < Z.rows(); ++i) {
      r(i, i) = kClose * Z(i, i);
      for (Eigen::Index j = i + 1; j < Z.rows(); ++j) {
        r(i, j) = kClose * std::sqrt(0.5) * (Z(i, j) + Z(j, i));
        r(j, i) = Z(i, j) - Z(j, i);
      }
    }
    return r;
  }
  static Small weigh_transposed(const Small& r) {
    Small g = r;
    for (Eigen::Index i = 0; i < r.rows(); ++i) {
      g(i, i) = kClose * r(i, i);
      for (Eigen::Index j = i + 1; j < r.rows(); ++j) {
        g(i, j) = kClose * std::sqrt(0.5) * r(i, j) + r(j, i);
        g(j, i) = kClose * std::sqrt(0.5) * r(i, j) - r(j, i);
      }
    }
    return g;
  }
  Small exchanged(std::size_t t, const std::vector<Vec3>& xi) const {
    const Stencil& s = stencils_[t];
    Small U(static_cast<Eigen::Index>(s.inner.size()), 3);
    for (std::size_t i = 0; i < s.inner.size(); ++i) {
      const int k = s.inner[i];
      U.row(static_cast<Eigen::Index>(i)) =
          mesh_[t].side[k] * mesh_[t].length(k) * xi[static_cast<std::size_t>(mesh_[t].edge[k])].transpose();
    }
    return U * s.from_angles;
  }
  std::vector<Vec3> pull_back(const std::vector<Small>& residual) const {
    std::vector<Vec3> g(xi_.size(), Vec3::Zero());
    for (std::size_t t = 0; t < stencils_.size(); ++t) {
      const Stencil& s = stencils_[t];
      const Small U = weigh_transposed(residual[t]) * s.from_angles.transpose();
      for (std::size_t i = 0; i < s.inner.size(); ++i) {
        const int k = s.inner[i];
        g[static_cast<std::size_t>(mesh_[t].edge[k])] +=
            mesh_[t].side[k] * mesh_[t].length(k) * U.row(static_cast<Eigen::Index>(i)).transpose();
      }
    }
    return g;
  }
  static Real squared(const std::vector<Vec3>& v) {
    Real sum = 0;
    for (const Vec3& x : v) sum += x.squaredNorm();
    return sum;
  }
  const std::vector<FlatTriangle>& mesh_;
  std::vector<Stencil> stencils_;
  std::vector<Vec3> xi_;
};
}  // namespace

Mat3 hinge_stiffness(const FlatTriangle& t) {
  Mat3 K = Mat3::Zero();
  for (int k = 0; k < 3; ++k)
    if (t.inner[k]) K(k, k) = t.along(k).squaredNorm() / (2 * (t.area() + t.neighbour_area(k)));
  return K;
}

Mat3 mean_normal_stiffness(const FlatTriangle& t) {
  Mat3 G;
  for (int k = 0; k < 3; ++k) G.col(k) = t.length(k) / (2 * t.area()) * product(t.normal(k), t.normal(k));
  Mat3 K = t.area() * G.transpose() * G;
  for (int k = 0; k < 3; ++k) {
    if (t.inner[k]) continue;
    if (K(k, k) > 0) K -= Mat3(K.col(k) * K.row(k) / K(k, k));
    K.col(k).setZero();
    K.row(k).setZero();
  }
  return K;
}

std::vector<Mat3> plate_stiffness(const std::vector<FlatTriangle>& mesh, int edges) {
  Exchange exchange(mesh, edges);
  exchange.solve();
  std::vector<Mat3> K;
  for (std::size_t t = 0; t < mesh.size(); ++t) K.push_back(exchange.stiffness(t));
  return K;
}
}  // namespace tape
