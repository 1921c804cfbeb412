#pragma once
#include "tape/effects/effect.hpp"

namespace tape {
/// Springs of the grips:  E = k/2 |x_v - t|^2,  t the target of the spring or, for a grip that ties to a body, its anchor there.
/// An open grip has k = 0.
struct Tether {
  static constexpr std::string_view name = "tether";
  using Params = NoParams;
  struct Element {
    int v;
    int anchor;  ///< vertex, v itself if the target moves by script
    int slot;    ///< of the target and the stiffness
  };
  Span<const Element> elements;

  static std::string needed(const Scene& scene, const Params&) { return scene.grips.empty() ? "" : "script"; }
  static Tether build(const Scene&, const Assembly& assembly, const Params&, std::vector<Element>& elements) {
    for (const Assembly::GripPart& grip : assembly.grips) {
      for (std::size_t k = 0; k < grip.vertices.size(); ++k) {
        const int v = grip.vertices[k], anchor = grip.anchors[k];
        elements.push_back({v, anchor < 0 ? v : anchor, static_cast<int>(elements.size())});
      }
    }
    return {};
  }
  TAPE_HD Stencil<2> stencil(int i) const { return {{elements[i].v, elements[i].anchor}}; }
  TAPE_HD bool anchored(int i) const { return elements[i].anchor != elements[i].v; }
  TAPE_HD bool active(const StateView& s, int i) const { return s.grip_stiffness[elements[i].slot] > 0; }
  /// k (x_v - t) [N].
  TAPE_HD inline Vec3 pull(const StateView& s, int i) const;
  TAPE_HD inline Real energy(const StateView& s, int i) const;
  TAPE_HD inline VecN<6> gradient(const StateView& s, int i) const;
  TAPE_HD inline MatN<6, 6> hessian(const StateView& s, int i, HessianMode) const;
};
static_assert(Effect<Tether>);
}  // namespace tape
