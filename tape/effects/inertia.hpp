#pragma once
#include "tape/effects/effect.hpp"

namespace tape {
/// Inertia of strip vertices, implicit Euler:  E = m |x - x_tilde|^2 / (2 dt^2),  x_tilde = x + dt v.
struct Inertia {
  static constexpr std::string_view name = "inertia";
  static constexpr bool sleeps = true;
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
  TAPE_HD inline Vec3 offset(const StateView& s, int i) const;
  TAPE_HD inline Real stiffness(const StateView& s, int i) const;
  TAPE_HD inline Real energy(const StateView& s, int i) const;
  TAPE_HD inline Vec3 gradient(const StateView& s, int i) const;
  TAPE_HD inline Mat3 hessian(const StateView& s, int i, HessianMode) const;
};
static_assert(Effect<Inertia>);
}  // namespace tape
