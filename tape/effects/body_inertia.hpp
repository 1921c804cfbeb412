#pragma once
#include "tape/effects/effect.hpp"
#include "tape/math/psd.hpp"
#include "tape/math/rotation.hpp"

namespace tape {
/// Sum of m/2 |x - x_target|^2 over a body's mass in closed form: with pose (R, t) and target pose (R', t'),
///   E = m/2 |t - t'|^2 + 1/2 tr((R - R') S (R - R')^T),   S = sum of m y y^T.
/// By (translation, rotation w from the left, R <- exp(skew w) R), with M = R S R'^T:
///   gradient (m (t - t'), axial(M)),   Hessian (m I, tr(M) I - (M + M^T)/2).
struct BodyQuadratic {
  Real mass;    ///< [kg] or a stiffness [N/m]
  Mat3 second;  ///< [kg m^2] or [N m]
  TAPE_HD Real energy(const Pose& at, const Pose& target) const {
    const Mat3 dR = at.rotation - target.rotation;
    return mass / 2 * (at.position - target.position).squaredNorm() + (dR * second).cwiseProduct(dR).sum() / 2;
  }
  TAPE_HD VecN<6> gradient(const Pose& at, const Pose& target) const {
    VecN<6> g;
    g.head<3>() = mass * (at.position - target.position);
    g.tail<3>() = axial(at.rotation * second * target.rotation.transpose());
    return g;
  }
  TAPE_HD MatN<6, 6> hessian(const Pose& at, const Pose& target, HessianMode mode) const {
    const Mat3 M = at.rotation * second * target.rotation.transpose();
    const Mat3 turn = M.trace() * Mat3::Identity() - 0.5 * (M + M.transpose());
    MatN<6, 6> h = MatN<6, 6>::Zero();
    h.topLeftCorner<3, 3>() = mass * Mat3::Identity();
    h.bottomRightCorner<3, 3>() = mode == HessianMode::projected ? psd_part(turn) : turn;
    return h;
  }
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
  TAPE_HD Real energy(const StateView& s, int i) const {
    const Element& e = elements[i];
    return quadratic(s, e).energy(s.body[e.body], s.body_target[e.body]) / (s.dt * s.dt);
  }
  TAPE_HD VecN<6> gradient(const StateView& s, int i) const {
    const Element& e = elements[i];
    return quadratic(s, e).gradient(s.body[e.body], s.body_target[e.body]) / (s.dt * s.dt);
  }
  TAPE_HD MatN<6, 6> hessian(const StateView& s, int i, HessianMode mode) const {
    const Element& e = elements[i];
    return quadratic(s, e).hessian(s.body[e.body], s.body_target[e.body], mode) / (s.dt * s.dt);
  }

 private:
  TAPE_HD static BodyQuadratic quadratic(const StateView& s, const Element& e) {
    return {s.body_mass[e.body].mass, s.body_mass[e.body].second};
  }
};
static_assert(Effect<BodyInertia>);
}  // namespace tape
