#pragma once
#include "tape/effects/coulomb.hpp"
#include "tape/effects/effect.hpp"

namespace tape {
/// Torque about an axle, against turning or towards a speed. The angle phi of the body's arm a on a dial (d, b) has
///   tan phi = s/c,   s = a.b,   c = a.d;
/// what it turns in a step beyond `speed` dt, the slip y, costs E = torque f0(|y|) (Coulomb), eps = creep dt. So a free axle has dry
/// friction and a driven one never exerts more than its torque. A step may turn by less than half a turn against the drive.
struct AxleTorque {
  static constexpr std::string_view name = "axle_torque";
  static constexpr bool incremental = true;
  struct Params {
    Real creep = 1e-2;
    template <class F>
    void fields(F&& f) {
      f("creep", creep, "rad/s", Range::above(0, 100), "speed, beyond that of its drive, below which an axle counts as sticking");
    }
  };
  struct Element {
    int v[5];     ///< markers: foot and tip of the arm; foot of the dial, its directions d and b
    Real torque;  ///< [N m]
    Real speed;   ///< [rad/s]
  };
  Span<const Element> elements;
  Real creep;

  static std::string needed(const Scene& scene, const Params&) {
    for (const AxleJoint& axle : scene.axles)
      if (axle.params.torque > 0) return "axles.torque";
    return "";
  }
  static AxleTorque build(const Scene& scene, const Assembly& assembly, const Params& p, std::vector<Element>& elements) {
    for (std::size_t k = 0; k < scene.axles.size(); ++k) {
      const Assembly::AxlePart& part = assembly.axles[k];
      const AxleParams& axle = scene.axles[k].params;
      elements.push_back({{part.end[0], part.arm, part.seat[0], part.dial[0], part.dial[1]}, axle.torque, axle.speed});
    }
    return {{}, p.creep};
  }
  TAPE_HD Stencil<5> stencil(int i) const {
    const int(&v)[5] = elements[i].v;
    return {{v[0], v[1], v[2], v[3], v[4]}};
  }
  TAPE_HD bool active(const StateView&, int i) const { return elements[i].torque > 0; }
  /// [rad] by which the step turns beyond the drive.
  TAPE_HD inline Real slip(const StateView& s, int i) const;
  /// [N m] that the axle exerts on the body, about the axis.
  TAPE_HD inline Real torque(const StateView& s, int i) const;
  TAPE_HD inline Real energy(const StateView& s, int i) const;
  TAPE_HD inline VecN<15> gradient(const StateView& s, int i) const;
  /// As of friction: beyond eps f0 is straight; after an update that overshot its secant stands in.
  TAPE_HD inline MatN<15, 15> hessian(const StateView& s, int i, HessianMode mode) const;

 private:
  TAPE_HD Coulomb law(const StateView& s) const { return {creep * s.dt}; }

  struct Turn;  // the angle phi as a function of the five markers
};
static_assert(Effect<AxleTorque>);
}  // namespace tape
