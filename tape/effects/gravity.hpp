#pragma once
#include "tape/effects/effect.hpp"

namespace tape {
/// Uniform gravity g [m/s^2]:  E = -m g.x  for each strip vertex and each body's centre of mass.
struct Gravity {
  static constexpr std::string_view name = "gravity";
  static constexpr bool sleeps = true;
  using Params = NoParams;
  struct Element {
    int v;
  };
  Span<const Element> elements;
  Vec3 g;  ///< [m/s^2]

  static std::string needed(const Scene& scene, const Params&) { return scene.gravity.isZero() ? "" : "gravity"; }
  static Gravity build(const Scene& scene, const Assembly& assembly, const Params&, std::vector<Element>& elements) {
    for (int v = 0; v < assembly.strip_vertices; ++v) elements.push_back({v});
    for (const BodyPart& body : assembly.bodies)
      if (body.motion == Motion::dynamic) elements.push_back({body.centre});
    return {{}, scene.gravity};
  }
  TAPE_HD Stencil<1> stencil(int i) const { return {{elements[i].v}}; }
  TAPE_HD inline Real energy(const StateView& s, int i) const;
  TAPE_HD inline Vec3 gradient(const StateView& s, int i) const;
  TAPE_HD inline Mat3 hessian(const StateView&, int, HessianMode) const;
};
static_assert(Effect<Gravity>);
}  // namespace tape
