#include "tape/effects/bending.hpp"

#include <Eigen/LU>
#include <map>
#include <utility>

namespace tape {
namespace {
/// A triangle of the flat mesh with the apexes of its neighbours. Edge k is opposite of vertex k.
struct Patch {
  Vec2 X[3];
  Vec2 apex[3];
  bool inner[3];  ///< edge k has a neighbour

  Vec2 edge(int k) const { return X[(k + 2) % 3] - X[(k + 1) % 3]; }
  /// Distance [m] of a point from edge k, positive on the triangle's side.
  Real height(int k, const Vec2& p) const {
    const Vec2 e = edge(k), r = p - X[(k + 1) % 3];
    return (e.x() * r.y() - e.y() * r.x()) / e.norm();
  }
  Real area() const { return height(0, X[0]) * edge(0).norm() / 2; }
  Real neighbour_area(int k) const { return -height(k, apex[k]) * edge(k).norm() / 2; }
};

/// E = k w theta^2 of each edge with k = D/6 and w = 3 |e|^2/(A1 + A2), half of it in each of its triangles.
Mat3 hinge_stiffness(const Patch& p, Real D) {
  Mat3 K = Mat3::Zero();
  for (int k = 0; k < 3; ++k)
    if (p.inner[k]) K(k, k) = D * p.edge(k).squaredNorm() / (2 * (p.area() + p.neighbour_area(k)));
  return K;
}

/// The curvature S = (Sxx, Syy, Sxy) [1/m] = G theta of the mean normals at the edges: S = sum_k theta_k l_k/(2 A) nu_k nu_k^T.
Mat3 mean_normal_curvature(const Patch& p) {
  Mat3 G = Mat3::Zero();
  for (int k = 0; k < 3; ++k) {
    if (!p.inner[k]) continue;
    const Vec2 e = p.edge(k), across = Vec2(e.y(), -e.x()) / e.norm();
    G.col(k) = e.norm() / (2 * p.area()) * Vec3(across.x() * across.x(), across.y() * across.y(), across.x() * across.y());
  }
  return G;
}

/// K of the plate energy A D/2 [(1 - nu) |S|^2 + nu tr^2 S] with S = G theta.
Mat3 plate_stiffness(const Mat3& G, Real area, Real D, Real nu) {
  const Eigen::RowVector3d trace = G.row(0) + G.row(1);
  const Mat3 squares = G.transpose() * Vec3(1, 1, 2).asDiagonal() * G;
  return area * D * ((1 - nu) * squares + nu * trace.transpose() * trace);
}
}  // namespace

std::string Bending::needed(const Scene& scene, const Params&) {
  for (const Strip& s : scene.strips)
    if (scene.films[static_cast<std::size_t>(s.film)].bending_modulus > 0) return "film.bending_modulus";
  return "";
}

Bending Bending::build(const Scene& scene, const Assembly& assembly, const Params& params, std::vector<Element>& elements) {
  for (const StripPart& strip : assembly.strips) {
    const Film& film = scene.films[static_cast<std::size_t>(strip.film)];
    if (film.bending_modulus == 0) continue;
    const auto corner = [&](int t, int k) { return assembly.triangles[static_cast<std::size_t>(t)][k % 3]; };
    const auto X = [&](int v) { return assembly.rest[static_cast<std::size_t>(v)]; };
    std::map<std::pair<int, int>, int> apex;  // of the triangle on the left of a directed edge
    for (int t = strip.first_triangle; t < strip.first_triangle + strip.triangles; ++t)
      for (int k = 0; k < 3; ++k) apex[{corner(t, k + 1), corner(t, k + 2)}] = corner(t, k);
    for (int t = strip.first_triangle; t < strip.first_triangle + strip.triangles; ++t) {
      Element e{};
      Patch p{};
      for (int k = 0; k < 3; ++k) {
        const auto found = apex.find({corner(t, k + 2), corner(t, k + 1)});
        p.inner[k] = found != apex.end();
        e.v[k] = corner(t, k);
        e.v[3 + k] = p.inner[k] ? found->second : e.v[k];
        p.X[k] = X(e.v[k]), p.apex[k] = X(e.v[3 + k]);
      }
      const Real D = film.plate_stiffness();
      const Mat3 K =
          params.law == BendingLaw::hinge ? hinge_stiffness(p, D) : plate_stiffness(mean_normal_curvature(p), p.area(), D, film.poisson);
      Eigen::Map<Mat3>(&e.K[0][0]) = K;
      elements.push_back(e);
    }
  }
  return {};
}
}  // namespace tape
