#pragma once
#include <algorithm>

#include "tape/effects/body_inertia.hpp"

namespace tape {
/// Holds driven bodies to the pose that the script prescribes, by a spring so stiff that its lag is negligible and readable:
/// the lag times the stiffness is the force that the world exerts on the body.
struct BodyDrive {
  static constexpr std::string_view name = "body_drive";
  static constexpr bool on_blocks = true;
  struct Params {
    Real stiffness = 1e9;
    template <class F>
    void fields(F&& f) {
      f("stiffness", stiffness, "N/m", Range::above(0, 1e12), "of a driven body's hold on its prescribed pose");
    }
  };
  struct Element {
    int body, block;
    BodyQuadratic stiffness;
  };
  Span<const Element> elements;

  static std::string needed(const Scene& scene, const Params&) {
    for (const Body& body : scene.bodies)
      if (body.motion == Motion::driven) return "bodies." + body.name + ".motion";
    return "";
  }
  static BodyDrive build(const Scene&, const Assembly& assembly, const Params& p, std::vector<Element>& elements) {
    for (std::size_t b = 0; b < assembly.bodies.size(); ++b) {
      const BodyPart& part = assembly.bodies[b];
      if (part.motion != Motion::driven) continue;
      Real radius = 0;
      for (int v = part.first_vertex; v < part.first_vertex + part.vertices; ++v)
        radius = std::max(radius, assembly.local[static_cast<std::size_t>(v)].norm());
      elements.push_back({static_cast<int>(b), part.block, {p.stiffness, p.stiffness * radius * radius / 2 * Mat3::Identity()}});
    }
    return {};
  }
  TAPE_HD Stencil<2> stencil(int i) const { return {{elements[i].block, elements[i].block + 1}}; }
  TAPE_HD inline Real energy(const StateView& s, int i) const;
  TAPE_HD inline VecN<6> gradient(const StateView& s, int i) const;
  TAPE_HD inline MatN<6, 6> hessian(const StateView& s, int i, HessianMode mode) const;
};
static_assert(Effect<BodyDrive>);
}  // namespace tape
