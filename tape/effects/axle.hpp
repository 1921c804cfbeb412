#pragma once
#include "tape/effects/effect.hpp"

namespace tape {
/// Springs that keep the two ends of each axle in their seats:  E = k/2 |x_end - x_seat|^2.
struct Axle {
  static constexpr std::string_view name = "axle";
  using Params = NoParams;
  struct Element {
    int end, seat;   ///< markers
    Real stiffness;  ///< [N/m]
  };
  Span<const Element> elements;

  static std::string needed(const Scene& scene, const Params&) { return scene.axles.empty() ? "" : "axles"; }
  static Axle build(const Scene&, const Assembly& assembly, const Params&, std::vector<Element>& elements) {
    for (const Assembly::AxlePart& axle : assembly.axles)
      for (int k = 0; k < 2; ++k) elements.push_back({axle.end[k], axle.seat[k], axle.stiffness});
    return {};
  }
  TAPE_HD Stencil<2> stencil(int i) const { return {{elements[i].end, elements[i].seat}}; }
  TAPE_HD inline Real energy(const StateView& s, int i) const;
  TAPE_HD inline VecN<6> gradient(const StateView& s, int i) const;
  TAPE_HD inline MatN<6, 6> hessian(const StateView&, int i, HessianMode) const;
};
static_assert(Effect<Axle>);
}  // namespace tape
