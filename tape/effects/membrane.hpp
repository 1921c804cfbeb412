#pragma once
#include "tape/effects/effect.hpp"

namespace tape {
/// In-plane stretch of the film: St. Venant-Kirchhoff on the flat rest mesh, plane stress, constant strain in a triangle.
/// With F = Ds Dm^-1 [3x2] and Green strain G = (F^T F - I)/2,
///   E = A h (mu |G|^2 + lambda/2 tr^2 G),  mu = E/(2 (1 + nu)), lambda = E nu/(1 - nu^2),  stress S = 2 mu G + lambda tr(G) I.
struct Membrane {
  static constexpr std::string_view name = "membrane";
  static constexpr bool sleeps = true;
  using Params = NoParams;
  struct Element {
    int v[3];
    Real b[3][2];     ///< [1/m] gradients of the three hat functions in the rest plane
    Real mu, lambda;  ///< [J] times the rest volume
  };
  Span<const Element> elements;

  static std::string needed(const Scene& scene, const Params&) { return scene.strips.empty() ? "" : "strip"; }
  static Membrane build(const Scene& scene, const Assembly& assembly, const Params&, std::vector<Element>& elements) {
    for (const StripPart& strip : assembly.strips) {
      const Film& film = scene.films[static_cast<std::size_t>(strip.film)];
      for (int t = strip.first_triangle; t < strip.first_triangle + strip.triangles; ++t)
        elements.push_back(element(film, assembly.triangles[static_cast<std::size_t>(t)], assembly.rest));
    }
    return {};
  }
  static Element element(const Film& film, const Index3& v, const std::vector<Vec2>& rest) {
    const auto X = [&](int k) -> const Vec2& { return rest[static_cast<std::size_t>(v[k % 3])]; };
    const Vec2 e1 = X(1) - X(0), e2 = X(2) - X(0);
    const Real area2 = e1.x() * e2.y() - e1.y() * e2.x(), volume = area2 / 2 * film.thickness;
    Element e{{v[0], v[1], v[2]}, {}, 0, 0};
    for (int k = 0; k < 3; ++k) {
      const Vec2 edge = X(k + 2) - X(k + 1);  // opposite of k; its left side looks at k
      e.b[k][0] = -edge.y() / area2, e.b[k][1] = edge.x() / area2;
    }
    e.mu = volume * film.membrane_modulus / (2 * (1 + film.poisson));
    e.lambda = volume * film.membrane_modulus * film.poisson / (1 - film.poisson * film.poisson);
    return e;
  }

  TAPE_HD Stencil<3> stencil(int i) const { return {{elements[i].v[0], elements[i].v[1], elements[i].v[2]}}; }
  TAPE_HD inline Mat32 deformation_gradient(const StateView& s, int i) const;
  TAPE_HD static inline Mat2 green_strain(const Mat32& F);
  TAPE_HD inline Mat2 stress(const Mat2& G, int i) const;  ///< [J]
  /// Larger principal strain in magnitude [1]: stretch less one.
  TAPE_HD inline Real strain(const StateView& s, int i) const;
  TAPE_HD inline Real energy(const StateView& s, int i) const;
  TAPE_HD inline VecN<9> gradient(const StateView& s, int i) const;
  /// Material part (always PSD) plus S acting on the change of F; `projected` clamps the 2x2 stress S to its tensile part.
  /// The clamp adds spurious stiffness against rotation where the film is compressed: that is what `exact` is there for.
  TAPE_HD inline MatN<9, 9> hessian(const StateView& s, int i, HessianMode mode) const;
};
static_assert(Effect<Membrane>);
}  // namespace tape
