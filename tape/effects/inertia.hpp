#pragma once
#include "tape/effects/effect.hpp"

namespace tape {
/// Inertia of strip vertices, implicit Euler:  E = m |x - x_tilde|^2 / (2 dt^2),  x_tilde = x + dt v.
struct Inertia {
  static constexpr std::string_view name = "inertia";
  static constexpr bool sleeps = true;
  static constexpr bool free_vertices = true;
  static constexpr bool incremental = true;
  using Params = NoParams;
  struct Element {
    int v;
  };
  Span<const Element> elements;

  static std::string needed(const Scene& scene, const Params&) { return scene.strips.empty() ? "" : "strip"; }
  static Inertia build(const Scene&, const Assembly& assembly, const Params&, std::vector<Element>& elements) {
    for (const StripPart& strip : assembly.strips)
      for (int v = strip.first_vertex; v < strip.first_vertex + strip.vertices; ++v) elements.push_back({v});
    return {};
  }
  TAPE_HD Stencil<1> stencil(int i) const { return {{elements[i].v}}; }
  TAPE_HD Vec3 offset(const StateView& s, int i) const { return s.x[elements[i].v] - s.x_tilde[elements[i].v]; }
  TAPE_HD Real stiffness(const StateView& s, int i) const { return s.mass[elements[i].v] / (s.dt * s.dt); }
  TAPE_HD Real energy(const StateView& s, int i) const { return 0.5 * stiffness(s, i) * offset(s, i).squaredNorm(); }
  TAPE_HD Vec3 gradient(const StateView& s, int i) const { return stiffness(s, i) * offset(s, i); }
  TAPE_HD Mat3 hessian(const StateView& s, int i, HessianMode) const { return stiffness(s, i) * Mat3::Identity(); }
};
static_assert(Effect<Inertia>);
}  // namespace tape
