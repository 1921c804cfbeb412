#pragma once
#include <array>

#include "tape/effects/effect.hpp"

namespace tape {
struct Dihedral;

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
  TAPE_HD inline Real energy(const StateView& s, int i) const;
  TAPE_HD inline VecN<18> gradient(const StateView& s, int i) const;
  /// J^T K J with J = d theta/dx, a sum of squares; `exact` adds the moments times the second derivatives of their angles.
  TAPE_HD inline MatN<18, 18> hessian(const StateView& s, int i, HessianMode mode) const;

 private:
  struct Angles;  // at the three edges, with their slope
  /// Place in the stencil of vertex p of the hinge at edge k: the edge's ends, then the two apexes.
  TAPE_HD static int corner(int k, int p) { return p == 0 ? (k + 1) % 3 : p == 1 ? (k + 2) % 3 : p == 2 ? k : k + 3; }
  TAPE_HD bool free_edge(int i, int k) const { return elements[i].v[3 + k] == elements[i].v[k]; }
  TAPE_HD inline Real moment(int i, const Real (&theta)[3], int k) const;  ///< [N m]
  TAPE_HD inline void positions(const StateView& s, int i, int k, Vec3 (&x)[4]) const;
  TAPE_HD inline Dihedral at_edge(const StateView& s, int i, int k) const;
  TAPE_HD inline Angles angles(const StateView& s, int i) const;
};
static_assert(Effect<Bending>);
}  // namespace tape
