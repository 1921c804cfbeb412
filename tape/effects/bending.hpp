#pragma once
#include <array>

#include "tape/effects/effect.hpp"
#include "tape/math/dihedral.hpp"

namespace tape {
enum class BendingLaw { hinge, shape_operator };
constexpr auto enum_names(BendingLaw) { return std::array<std::string_view, 2>{"hinge", "shape_operator"}; }

struct BendingParams {
  BendingLaw law = BendingLaw::shape_operator;
  template <class F>
  void fields(F&& f) {
    f("law", law, "", Range::any(), "energy of bent edges one by one (hinge), or of the curvature of each triangle (shape_operator)");
  }
};

/// Bending of the film, flat at rest. Per triangle, over the angles theta [3] rad at its edges,
///   E = 1/2 theta^T K theta,
/// where K [3x3] J depends on the law and the flat mesh alone (README.md): `hinge` is diagonal, `shape_operator` the plate energy
/// A D/2 |S|^2 of the curvature S that the three angles stand for.
struct Bending {
  static constexpr std::string_view name = "bending";
  static constexpr bool sleeps = true;
  using Params = BendingParams;
  struct Element {
    int v[6];      ///< the triangle, then the apex of the neighbour across the edge opposite of each vertex; v[k] at a free edge
    Real K[3][3];  ///< [J] zero in rows and columns of free edges
  };
  Span<const Element> elements;

  static std::string needed(const Scene& scene, const Params&);
  static Bending build(const Scene& scene, const Assembly& assembly, const Params& params, std::vector<Element>& elements);

  TAPE_HD Stencil<6> stencil(int i) const {
    const int(&v)[6] = elements[i].v;
    return {{v[0], v[1], v[2], v[3], v[4], v[5]}};
  }
  TAPE_HD Real energy(const StateView& s, int i) const {
    Real theta[3];
    for (int k = 0; k < 3; ++k) theta[k] = free_edge(i, k) ? 0 : at_edge(s, i, k).angle;
    return 0.5 * (theta[0] * moment(i, theta, 0) + theta[1] * moment(i, theta, 1) + theta[2] * moment(i, theta, 2));
  }
  TAPE_HD VecN<18> gradient(const StateView& s, int i) const {
    const Angles a = angles(s, i);
    return a.slope.transpose() * Vec3(moment(i, a.theta, 0), moment(i, a.theta, 1), moment(i, a.theta, 2));
  }
  /// J^T K J with J = d theta/dx, a sum of squares; `exact` adds the moments times the second derivatives of their angles.
  TAPE_HD MatN<18, 18> hessian(const StateView& s, int i, HessianMode mode) const {
    const Angles a = angles(s, i);
    const Mat3 K = Eigen::Map<const Mat3>(&elements[i].K[0][0]);
    MatN<18, 18> h = a.slope.transpose() * (K * a.slope);
    if (mode == HessianMode::projected) return h;
    for (int k = 0; k < 3; ++k) {
      if (free_edge(i, k)) continue;
      Vec3 x[4];
      positions(s, i, k, x);
      const MatN<12, 12> second = moment(i, a.theta, k) * dihedral_hessian(x);
      for (int p = 0; p < 4; ++p)
        for (int q = 0; q < 4; ++q) h.block<3, 3>(3 * corner(k, p), 3 * corner(k, q)) += second.block<3, 3>(3 * p, 3 * q);
    }
    return h;
  }

 private:
  struct Angles {
    Real theta[3];
    MatN<3, 18> slope;
  };
  /// Place in the stencil of vertex p of the hinge at edge k: the edge's ends, then the two apexes.
  TAPE_HD static int corner(int k, int p) { return p == 0 ? (k + 1) % 3 : p == 1 ? (k + 2) % 3 : p == 2 ? k : k + 3; }
  TAPE_HD bool free_edge(int i, int k) const { return elements[i].v[3 + k] == elements[i].v[k]; }
  TAPE_HD Real moment(int i, const Real (&theta)[3], int k) const {  // [N m]
    const Real(&row)[3] = elements[i].K[k];
    return row[0] * theta[0] + row[1] * theta[1] + row[2] * theta[2];
  }
  TAPE_HD void positions(const StateView& s, int i, int k, Vec3 (&x)[4]) const {
    for (int p = 0; p < 4; ++p) x[p] = s.x[elements[i].v[corner(k, p)]];
  }
  TAPE_HD Dihedral at_edge(const StateView& s, int i, int k) const {
    Vec3 x[4];
    positions(s, i, k, x);
    return dihedral(x);
  }
  TAPE_HD Angles angles(const StateView& s, int i) const {
    Angles a{{0, 0, 0}, MatN<3, 18>::Zero()};
    for (int k = 0; k < 3; ++k) {
      if (free_edge(i, k)) continue;
      const Dihedral d = at_edge(s, i, k);
      a.theta[k] = d.angle;
      for (int p = 0; p < 4; ++p) a.slope.block<1, 3>(k, 3 * corner(k, p)) = d.gradient[p].transpose();
    }
    return a;
  }
};
static_assert(Effect<Bending>);
}  // namespace tape
