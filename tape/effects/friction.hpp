#pragma once
#include "tape/effects/barrier.hpp"

namespace tape {
/// Coulomb friction, smoothed and lagged [Li 2020]. At the start of a step each pair in contact fixes its normal force lambda_n
/// and tangent plane T; sliding by u = T^T sum_i w_i (x_i - x_start_i) then costs
///   E = mu lambda_n f0(|u|),   f0(y) = y for y >= eps, else -y^3/(3 eps^2) + y^2/eps + eps/3,   eps = eps_v dt.
/// Below the speed eps_v a contact creeps instead of sticking. Pairs of nearly parallel edges are left out: their vertices'
/// pairs carry the force.
struct Friction {
  static constexpr std::string_view name = "friction";
  static constexpr bool incremental = true;
  struct Params {
    Real eps_v = 1e-4;
    template <class F>
    void fields(F&& f) {
      f("eps_v", eps_v, "m/s", Range::above(0, 1), "sliding speed below which a contact counts as sticking");
    }
  };
  struct Element {
    int v[4];
    Real weight[4];
    Mat32 T;     ///< tangent basis
    Real limit;  ///< [N] mu lambda_n
  };
  Span<const Element> elements;
  Real eps_v;
  Barrier barrier;

  static std::string needed(const Scene& scene, const Params&) {
    if (Barrier::needed(scene, {}).empty()) return "";
    for (const Material& a : scene.materials)
      for (const Material& b : scene.materials)
        if (scene.mu(static_cast<int>(&a - scene.materials.data()), static_cast<int>(&b - scene.materials.data())) > 0)
          return "materials.mu";
    return "";
  }
  static Friction build(const Scene& scene, const Assembly& assembly, const Params& p, std::vector<Element>&) {
    std::vector<ContactPair> none;
    return {{}, p.eps_v, Barrier::build(scene, assembly, {}, none)};
  }
  TAPE_HD bool lag(const ContactPair& pair, const StateView& s, Element& out) const {
    const Real mu = s.mu[pair.interface];
    if (!(mu > 0)) return false;
    const PairState p = PairState::at(pair, s.x);
    if (!Barrier::reaches(p, pair) || p.fade.slope != 0) return false;
    const Real force = barrier.normal_force(p, pair);
    if (!(force > 0)) return false;
    const Vec3 n = p.normal();
    const Vec3 axis = std::fabs(n.x()) < 0.6 ? Vec3(1, 0, 0) : Vec3(0, 1, 0);
    const Vec3 t = n.cross(axis).normalized();
    for (int k = 0; k < 4; ++k) out.v[k] = pair.v[k], out.weight[k] = p.closest.weight[k];
    out.T.col(0) = t;
    out.T.col(1) = n.cross(t);
    out.limit = mu * force;
    return true;
  }
  TAPE_HD Stencil<4> stencil(int i) const { return {{elements[i].v[0], elements[i].v[1], elements[i].v[2], elements[i].v[3]}}; }
  TAPE_HD Vec2 slip(const StateView& s, int i) const {
    const Element& e = elements[i];
    Vec3 u = Vec3::Zero();
    for (int k = 0; k < 4; ++k) u += e.weight[k] * (s.x[e.v[k]] - s.x_start[e.v[k]]);
    return e.T.transpose() * u;
  }
  TAPE_HD Real energy(const StateView& s, int i) const {
    const Real y = slip(s, i).norm(), eps = eps_v * s.dt;
    return elements[i].limit * (y >= eps ? y : y * y / eps * (1 - y / (3 * eps)) + eps / 3);
  }
  /// f0'(y) / y [1/m].
  TAPE_HD static Real secant(Real y, Real eps) { return y >= eps ? 1 / y : (2 - y / eps) / eps; }
  TAPE_HD VecN<12> gradient(const StateView& s, int i) const {
    const Vec2 u = slip(s, i);
    return spread(i, elements[i].limit * secant(u.norm(), eps_v * s.dt) * (elements[i].T * u));
  }
  /// Positive semidefinite as it is: f0 is convex. But it is flat along a slip beyond eps and does not see that f0 turns at slip 0. Where
  /// Newton overshoots, the secant f0'(y)/y stands in for both directions: the parabola through y that lies above f0 everywhere.
  TAPE_HD MatN<12, 12> hessian(const StateView& s, int i, HessianMode) const {
    const Element& e = elements[i];
    const Vec2 u = slip(s, i);
    const Real y = u.norm(), eps = eps_v * s.dt;
    Mat2 m = secant(y, eps) * Mat2::Identity();
    if (!s.overshot && y > 0) m -= Mat2(u * u.transpose()) * (y >= eps ? 1 / (y * y * y) : 1 / (y * eps * eps));
    const Mat3 block = e.limit * e.T * m * e.T.transpose();
    MatN<12, 12> h;
    for (int k = 0; k < 4; ++k)
      for (int l = 0; l < 4; ++l) h.block<3, 3>(3 * k, 3 * l) = e.weight[k] * e.weight[l] * block;
    return h;
  }

  TAPE_HD VecN<12> spread(int i, const Vec3& force) const {
    VecN<12> g;
    for (int k = 0; k < 4; ++k) g.segment<3>(3 * k) = elements[i].weight[k] * force;
    return g;
  }
};
static_assert(Effect<Friction>);
}  // namespace tape
