#pragma once
#include "tape/effects/effect.hpp"
#include "tape/math/psd.hpp"

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
  TAPE_HD Mat32 deformation_gradient(const StateView& s, int i) const {
    const Element& e = elements[i];
    const Vec3 a = s.x[e.v[1]] - s.x[e.v[0]], b = s.x[e.v[2]] - s.x[e.v[0]];
    Mat32 F;
    F.col(0) = e.b[1][0] * a + e.b[2][0] * b;
    F.col(1) = e.b[1][1] * a + e.b[2][1] * b;
    return F;
  }
  TAPE_HD static Mat2 green_strain(const Mat32& F) { return 0.5 * (F.transpose() * F - Mat2::Identity()); }
  TAPE_HD Mat2 stress(const Mat2& G, int i) const {  // [J]
    return 2 * elements[i].mu * G + elements[i].lambda * G.trace() * Mat2::Identity();
  }
  /// Larger principal strain in magnitude [1]: stretch less one.
  TAPE_HD Real strain(const StateView& s, int i) const {
    const Mat32 F = deformation_gradient(s, i);
    const Mat2 C = F.transpose() * F;
    const Real mean = C.trace() / 2, radius = std::hypot((C(0, 0) - C(1, 1)) / 2, C(0, 1));
    return std::fmax(std::fabs(std::sqrt(mean + radius) - 1), std::fabs(std::sqrt(std::fmax(mean - radius, 0.0)) - 1));
  }
  TAPE_HD Real energy(const StateView& s, int i) const {
    const Mat2 G = green_strain(deformation_gradient(s, i));
    return elements[i].mu * G.squaredNorm() + elements[i].lambda / 2 * G.trace() * G.trace();
  }
  TAPE_HD VecN<9> gradient(const StateView& s, int i) const {
    const Mat32 F = deformation_gradient(s, i), P = F * stress(green_strain(F), i);
    VecN<9> g;
    for (int k = 0; k < 3; ++k) g.segment<3>(3 * k) = elements[i].b[k][0] * P.col(0) + elements[i].b[k][1] * P.col(1);
    return g;
  }
  /// Material part (always PSD) plus S acting on the change of F; `projected` clamps the 2x2 stress S to its tensile part.
  /// The clamp adds spurious stiffness against rotation where the film is compressed: that is what `exact` is there for.
  TAPE_HD MatN<9, 9> hessian(const StateView& s, int i, HessianMode mode) const {
    const Element& e = elements[i];
    const Mat32 F = deformation_gradient(s, i);
    const Mat2 full = stress(green_strain(F), i), S = mode == HessianMode::projected ? psd_part(full) : full;
    const Mat3 FFt = F * F.transpose();
    Vec3 u[3];
    for (int k = 0; k < 3; ++k) u[k] = e.b[k][0] * F.col(0) + e.b[k][1] * F.col(1);
    MatN<9, 9> h;
    for (int k = 0; k < 3; ++k) {
      for (int l = k; l < 3; ++l) {
        const Real bb = e.b[k][0] * e.b[l][0] + e.b[k][1] * e.b[l][1];
        const Real geometric =
            e.b[k][0] * (S(0, 0) * e.b[l][0] + S(0, 1) * e.b[l][1]) + e.b[k][1] * (S(1, 0) * e.b[l][0] + S(1, 1) * e.b[l][1]);
        const Mat3 block = e.mu * (bb * FFt + u[l] * u[k].transpose()) + e.lambda * u[k] * u[l].transpose() + geometric * Mat3::Identity();
        h.block<3, 3>(3 * k, 3 * l) = block;
        if (l > k) h.block<3, 3>(3 * l, 3 * k) = block.transpose();
      }
    }
    return h;
  }
};
static_assert(Effect<Membrane>);
}  // namespace tape
