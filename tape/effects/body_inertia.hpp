#pragma once
#include "tape/effects/effect.hpp"

namespace tape {
/// Sum of m/2 |x - x_target|^2 over a body's mass in closed form: with pose (R, t) and target pose (R', t'),
///   E = m/2 |t - t'|^2 + 1/2 tr((R - R') S (R - R')^T),   S = sum of m y y^T.
/// By (translation, rotation w from the left, R <- exp(skew w) R), with M = R S R'^T:
///   gradient (m (t - t'), axial(M)),   Hessian (m I, J(M)),   J(M) = tr(M) I - (M + M^T)/2.
/// Far from the target J(M) is no longer positive. The mean of the inertias at both poses, (J(R S R^T) + J(R' S R'^T))/2, is never less
/// than J(M), as m |y - y'|^2 >= 0 for each point: `projected` has it there, so that a body that nothing touches still has a step.
struct BodyQuadratic {
  Real mass;    ///< [kg] or a stiffness [N/m]
  Mat3 second;  ///< [kg m^2] or [N m]
  TAPE_HD inline Real energy(const Pose& at, const Pose& target) const;
  TAPE_HD inline VecN<6> gradient(const Pose& at, const Pose& target) const;
  TAPE_HD inline MatN<6, 6> hessian(const Pose& at, const Pose& target, HessianMode mode) const;
};

/// Inertia of dynamic bodies. The target is where the body's velocity and torque-free rotation take it (bodies/free_flight.hpp),
/// so that free motion keeps momentum and energy.
struct BodyInertia {
  static constexpr std::string_view name = "body_inertia";
  static constexpr bool on_blocks = true;
  static constexpr bool incremental = true;
  using Params = NoParams;
  struct Element {
    int body, block;
  };
  Span<const Element> elements;

  static std::string needed(const Scene& scene, const Params&) {
    for (const Body& body : scene.bodies)
      if (body.motion == Motion::dynamic) return "bodies." + body.name + ".motion";
    for (const Strip& strip : scene.strips)
      if (scene.reduces(strip)) return "model";
    return "";
  }
  static BodyInertia build(const Scene&, const Assembly& assembly, const Params&, std::vector<Element>& elements) {
    for (std::size_t b = 0; b < assembly.bodies.size(); ++b) {
      const BodyPart& part = assembly.bodies[b];
      if (part.motion == Motion::dynamic) elements.push_back({static_cast<int>(b), part.block});
    }
    return {};
  }
  TAPE_HD Stencil<2> stencil(int i) const { return {{elements[i].block, elements[i].block + 1}}; }
  TAPE_HD inline Real energy(const StateView& s, int i) const;
  TAPE_HD inline VecN<6> gradient(const StateView& s, int i) const;
  TAPE_HD inline MatN<6, 6> hessian(const StateView& s, int i, HessianMode mode) const;

 private:
  TAPE_HD static inline BodyQuadratic quadratic(const StateView& s, const Element& e);
};
static_assert(Effect<BodyInertia>);
}  // namespace tape
