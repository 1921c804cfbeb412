#pragma once
#include <array>
#include <string_view>

#include "tape/effects/barrier.hpp"

namespace tape {
/// What slip is measured in: a frame that turns with the pair, or the tangent plane of the start of the step.
enum class SlipFrame { turning, fixed };
constexpr auto enum_names(SlipFrame) { return std::array<std::string_view, 2>{"turning", "fixed"}; }

/// Coulomb friction, smoothed and lagged [Li 2020]. At the start of a step each pair in contact fixes its normal force lambda_n, its
/// closest points and the tangent plane T; sliding by u then costs
///   E = mu lambda_n f0(|u|),   f0(y) = y for y >= eps, else -y^3/(3 eps^2) + y^2/eps + eps/3,   eps = eps_v dt.
/// `fixed` is the published u = T^T (r - r_start) of the way r = sum_i w_i x_i between the points. Surfaces keep a distance, so that a pair
/// that turns as a whole seems to slip by that distance times the angle: the layers of a roll then hold it fast. `turning` measures r
/// along two edges e of the pair, y = (e_0.r, e_1.r, (e_0 x e_1).r), which a rigid motion leaves alone: u = T^T B^-T (y - y_start), B =
/// (e_0, e_1, e_0 x e_1) when the step started; to first order the same, less the turning. Below the speed eps_v a contact creeps instead
/// of sticking. Pairs of nearly parallel edges are left out: their vertices' pairs carry the force.
struct Friction {
  static constexpr std::string_view name = "friction";
  static constexpr bool incremental = true;
  struct Params {
    Real eps_v = 1e-4;
    SlipFrame frame = SlipFrame::turning;
    template <class F>
    void fields(F&& f) {
      f("eps_v", eps_v, "m/s", Range::above(0, 1), "sliding speed below which a contact counts as sticking");
      f("frame", frame, "", Range::any(),
        "slip by a frame that turns with the pair, or by the one of the start of the step (as published)");
    }
  };
  struct Element {
    int v[4];
    PairKind kind;
    Real weight[4];
    Mat32 T;                            ///< tangent basis
    Eigen::Matrix<Real, 2, 3> slip_of;  ///< T^T B^-T
    Vec3 start;                         ///< y_start
    Real limit;                         ///< [N] mu lambda_n
  };
  Span<const Element> elements;
  Real eps_v;
  SlipFrame frame;
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
    return {{}, p.eps_v, p.frame, Barrier::build(scene, assembly, {}, none)};
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
    out.kind = pair.kind;
    out.T.col(0) = t;
    out.T.col(1) = n.cross(t);
    out.limit = mu * force;
    const Way way(out, s.x);
    Mat3 B;
    B << way.e[0], way.e[1], way.e[0].cross(way.e[1]);
    out.slip_of = out.T.transpose() * B.inverse().transpose();
    out.start = way.along();
    return true;
  }
  TAPE_HD Stencil<4> stencil(int i) const { return {{elements[i].v[0], elements[i].v[1], elements[i].v[2], elements[i].v[3]}}; }
  TAPE_HD Vec2 slip(const StateView& s, int i) const {
    const Element& e = elements[i];
    if (frame == SlipFrame::turning) return e.slip_of * (Way(e, s.x).along() - e.start);
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
    return slope(s, i) * (elements[i].limit * secant(u.norm(), eps_v * s.dt) * u);
  }
  /// In the slip positive semidefinite as it is: f0 is convex. But it is flat along a slip beyond eps and does not see that f0 turns at
  /// slip 0. Where Newton overshoots, the secant f0'(y)/y stands in for both directions: the parabola through y that lies above f0
  /// everywhere.
  TAPE_HD MatN<12, 12> hessian(const StateView& s, int i, HessianMode mode) const {
    const Element& e = elements[i];
    const Vec2 u = slip(s, i);
    const Real y = u.norm(), eps = eps_v * s.dt, pull = secant(y, eps);
    Mat2 m = pull * Mat2::Identity();
    if (!s.overshot && y > 0) m -= Mat2(u * u.transpose()) * (y >= eps ? 1 / (y * y * y) : 1 / (y * eps * eps));
    const MatN<12, 2> J = slope(s, i);
    MatN<12, 12> h = e.limit * J * m * J.transpose();
    if (frame == SlipFrame::turning && mode == HessianMode::exact && !s.overshot)
      Way(e, s.x).add_curvature(e.slip_of.transpose() * (e.limit * pull * u), h);
    return h;
  }

 private:
  /// The way between the lagged points of a pair, and two edges of the pair that turn with it.
  struct Way {
    Vec3 e[2], r;
    Real w[4], edge[2][4];  ///< r = sum w_k x_k, e_a = sum edge_ak x_k
    TAPE_HD Way(const Element& element, Span<const Vec3> positions) : r(Vec3::Zero()), edge{{0, 0, 0, 0}, {0, 0, 0, 0}} {
      const bool face = element.kind == PairKind::vertex_triangle;
      edge[0][face ? 1 : 0] = edge[1][face ? 1 : 2] = -1;
      edge[0][face ? 2 : 1] = edge[1][3] = 1;
      Vec3 x[4];
      for (int k = 0; k < 4; ++k) x[k] = positions[element.v[k]], w[k] = element.weight[k];
      for (int k = 1; k < 4; ++k) r += w[k] * (x[k] - x[0]);
      e[0] = face ? x[2] - x[1] : x[1] - x[0];
      e[1] = face ? x[3] - x[1] : x[3] - x[2];
    }
    /// y.
    TAPE_HD Vec3 along() const { return {e[0].dot(r), e[1].dot(r), e[0].cross(e[1]).dot(r)}; }
    /// dy_c/dx_k.
    TAPE_HD Mat3 slope(int k) const {
      Mat3 d;
      d << w[k] * e[0] + edge[0][k] * r, w[k] * e[1] + edge[1][k] * r,
          w[k] * e[0].cross(e[1]) + edge[0][k] * e[1].cross(r) + edge[1][k] * r.cross(e[0]);
      return d;
    }
    /// h += sum_c g_c d2y_c/dx2.
    TAPE_HD void add_curvature(const Vec3& g, MatN<12, 12>& h) const {
      const auto turn = [](const Real(&a)[4], const Real(&b)[4], int k, int l) { return a[k] * b[l] - b[k] * a[l]; };
      for (int k = 0; k < 4; ++k)
        for (int l = 0; l < 4; ++l) {
          Real both = 0;
          for (int a = 0; a < 2; ++a) both += g[a] * (edge[a][k] * w[l] + w[k] * edge[a][l]);
          h.block<3, 3>(3 * k, 3 * l) +=
              both * Mat3::Identity() +
              g[2] * (turn(edge[0], w, k, l) * skew(e[1]) + turn(w, edge[1], k, l) * skew(e[0]) + turn(edge[1], edge[0], k, l) * skew(r));
        }
    }
  };
  /// du/dx.
  TAPE_HD MatN<12, 2> slope(const StateView& s, int i) const {
    const Element& e = elements[i];
    MatN<12, 2> J;
    if (frame == SlipFrame::turning) {
      const Way way(e, s.x);
      for (int k = 0; k < 4; ++k) J.block<3, 2>(3 * k, 0) = way.slope(k) * e.slip_of.transpose();
    } else {
      for (int k = 0; k < 4; ++k) J.block<3, 2>(3 * k, 0) = e.weight[k] * e.T;
    }
    return J;
  }
};
static_assert(Effect<Friction>);
}  // namespace tape
