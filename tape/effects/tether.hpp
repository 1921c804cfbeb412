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
  TAPE_HD Vec3 pull(const StateView& s, int i) const {
    const Element& e = elements[i];
    return s.grip_stiffness[e.slot] * (s.x[e.v] - (anchored(i) ? s.x[e.anchor] : s.grip_target[e.slot]));
  }
  TAPE_HD Real energy(const StateView& s, int i) const {
    const Real k = s.grip_stiffness[elements[i].slot];
    return k > 0 ? pull(s, i).squaredNorm() / (2 * k) : 0;
  }
  TAPE_HD VecN<6> gradient(const StateView& s, int i) const {
    VecN<6> g = VecN<6>::Zero();
    g.head<3>() = pull(s, i);
    if (anchored(i)) g.tail<3>() = -g.head<3>();
    return g;
  }
  TAPE_HD MatN<6, 6> hessian(const StateView& s, int i, HessianMode) const {
    const Mat3 k = s.grip_stiffness[elements[i].slot] * Mat3::Identity();
    MatN<6, 6> h = MatN<6, 6>::Zero();
    h.topLeftCorner<3, 3>() = k;
    if (!anchored(i)) return h;
    h.bottomRightCorner<3, 3>() = k;
    h.topRightCorner<3, 3>() = h.bottomLeftCorner<3, 3>() = -k;
    return h;
  }
};
static_assert(Effect<Tether>);
}  // namespace tape
