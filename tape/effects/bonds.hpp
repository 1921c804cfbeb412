#pragma once
#include "tape/effects/cohesion.hpp"
#include "tape/math/psd.hpp"

namespace tape {
/// Releasable bonds: vertex x_0 and triangle x_1 x_2 x_3 span a virtual tetrahedron with reference shape D_b = [x_k - x_0] from when the
/// bond was made. With F = D_s D_b^-1 and volume V = |det D_b|/6,
///   E = V kappa_b |F F^T - I|^2        [the paper, eq. 4]
/// replaces contact, friction and cohesion of the pair. The energy does not see a reflection, so below half its rest distance the pair
/// gets a barrier back, C1 and without thickness: the flip guard. A bond is released by force, in tension only.
struct Bonds {
  static constexpr std::string_view name = "bonds";
  using Params = NoParams;
  using Pair = ContactPair;
  /// What a bond remembers. One that was released is remembered for a while, so that it is not made again.
  struct Memory : VertexTriangle {
    int cooldown;  ///< steps until a released pair may bond again; 0: it is bonded and replaces the contact of the pair
    Real rest;     ///< [m] distance when it was made
    Mat3 inverse;  ///< [1/m] D_b^-1
    bool replaces_contact() const { return cooldown == 0; }
    Real engagement(const Adhesion&) const { return cooldown == 0 ? 1 : 0; }
    template <class F>
    void visit(F&& f) {
      f(vertex), f(triangle), f(cooldown), f(rest);
      for (int k = 0; k < 9; ++k) f(inverse.data()[k]);
    }
  };
  struct Element {
    ContactPair pair;
    Mat3 inverse;    ///< [1/m] D_b^-1
    Real stiffness;  ///< [J] V kappa_b; 0: released
    Real rest;       ///< [m]
  };
  Span<const Element> elements;
  Real dhat;   ///< [m]
  Real kappa;  ///< [Pa] of the barrier

  static constexpr AdhesionLaw of_law = AdhesionLaw::bond;
  static std::string needed(const Scene& scene, const Params&) { return scene.uses(of_law) ? "interfaces" : ""; }
  static Bonds build(const Scene& scene, const Assembly&, const Params&, std::vector<Element>&) {
    return {{}, scene.dhat(), scene.contact.kappa};
  }
  TAPE_HD Element recall(const Memory& m, const ContactPair& pair, const StateView& s) const {
    const Real volume = 1 / (6 * std::fabs(m.inverse.determinant()));
    return {pair, m.inverse, m.cooldown > 0 ? 0 : volume * s.adhesion[pair.interface].bond.kappa_b, m.rest};
  }

  TAPE_HD Stencil<4> stencil(int i) const {
    const int(&v)[4] = elements[i].pair.v;
    return {{v[0], v[1], v[2], v[3]}};
  }
  TAPE_HD bool active(const StateView&, int i) const { return elements[i].stiffness > 0; }
  TAPE_HD Real energy(const StateView& s, int i) const {
    const Element& e = elements[i];
    if (!(e.stiffness > 0)) return 0;
    return e.stiffness * strain(deformation(e, s)).squaredNorm() + guard(e, PairState::at(e.pair, s.x)).value;
  }
  TAPE_HD VecN<12> gradient(const StateView& s, int i) const {
    const Element& e = elements[i];
    const PairState p = PairState::at(e.pair, s.x);
    return bond_gradient(e, s) + guard(e, p).slope * p.gradient();
  }
  /// With b_k the rows of D_b^-1 (b_0 minus their sum), f_k = F b_k and S = F F^T - I the blocks are
  ///   4 V kappa_b [(f_k.f_l) I + f_l f_k^T + (b_k.b_l) S];
  /// the first two make a square, so that `projected` need only clamp S.
  TAPE_HD MatN<12, 12> hessian(const StateView& s, int i, HessianMode mode) const {
    const Element& e = elements[i];
    const Mat3 F = deformation(e, s);
    const Mat3 S = mode == HessianMode::exact ? strain(F) : psd_part(strain(F));
    Vec3 b[4], f[4];
    for (int k = 0; k < 4; ++k) b[k] = row(e, k), f[k] = F * b[k];
    MatN<12, 12> h;
    for (int k = 0; k < 4; ++k)
      for (int l = 0; l < 4; ++l)
        h.block<3, 3>(3 * k, 3 * l) = 4 * e.stiffness * (f[k].dot(f[l]) * Mat3::Identity() + f[l] * f[k].transpose() + b[k].dot(b[l]) * S);
    const PairState p = PairState::at(e.pair, s.x);
    const Jet wall = guard(e, p);
    if (wall.curvature == 0) return h;
    const VecN<12> g = p.gradient();
    if (mode == HessianMode::exact) return h + p.hessian(wall.slope, wall.curvature);
    return h + wall.curvature * g * g.transpose();
  }

  /// Bonds form where the vertex stands over the face, within reach and not pressed below the floor.
  TAPE_HD bool begin(const ContactPair& pair, const StateView& s, Memory& out) const {
    const Adhesion& a = s.adhesion[pair.interface];
    if (a.law != of_law || far_apart(pair, s.x, pair.xi + a.bond.reach * dhat)) return false;
    const PairState p = PairState::at(pair, s.x);
    const Real gap = (p.d - pair.xi) / dhat;
    constexpr Real kFlat = 1e-6;  // [m] a tetrahedron that is no higher has no shape to remember
    if (p.closest.free != 2 || !(p.d > kFlat) || !(gap < a.bond.reach && gap >= a.bond.floor) || !adheres(a, pair, p, s)) return false;
    out = {pair.name(), 0, p.d, edges(p.x).inverse()};
    return true;
  }
  TAPE_HD bool renew(const StateView& s, int i, Memory& m) const {
    if (m.cooldown > 0) return --m.cooldown > 0;
    if (!gives_way(s, i)) return true;
    m.cooldown = s.adhesion[elements[i].pair.interface].bond.cooldown;
    return m.cooldown > 0;
  }
  /// In tension, with more than the break force on the vertex.
  TAPE_HD bool gives_way(const StateView& s, int i) const {
    const Element& e = elements[i];
    return e.stiffness > 0 && in_tension(e, s) && bond_gradient(e, s).head<3>().norm() > s.adhesion[e.pair.interface].bond.break_force;
  }
  /// Near its release the force of a bond must be known to a twentieth, or errors of the solver release it: stiffness 8 V kappa_b/h^2.
  TAPE_HD Real accuracy_to_judge(const StateView& s, int i) const {
    const Element& e = elements[i];
    const Real limit = s.adhesion[e.pair.interface].bond.break_force;
    if (!(e.stiffness > 0) || !in_tension(e, s) || !(bond_gradient(e, s).head<3>().norm() > 0.8 * limit))
      return std::numeric_limits<Real>::infinity();
    return 0.05 * limit * e.rest * e.rest / (8 * e.stiffness);
  }
  TAPE_HD AdhesiveForce force(const StateView& s, int i) const {
    const Element& e = elements[i];
    const PairState p = PairState::at(e.pair, s.x);
    const Vec3 pull = e.stiffness > 0 ? Vec3(gradient(s, i).head<3>()) : Vec3(Vec3::Zero()), n = p.normal();
    return {.interface = e.pair.interface,
            .vertex = {e.pair.v[0]},
            .weight = {1},
            .live = e.stiffness > 0,
            .normal = pull.dot(n),
            .tangential = (pull - pull.dot(n) * n).norm()};
  }

 private:
  TAPE_HD static Mat3 edges(const Vec3 (&x)[4]) {
    Mat3 D;
    for (int k = 0; k < 3; ++k) D.col(k) = x[k + 1] - x[0];
    return D;
  }
  TAPE_HD static Mat3 deformation(const Element& e, const StateView& s) {
    const int(&v)[4] = e.pair.v;
    const Vec3 x[4] = {s.x[v[0]], s.x[v[1]], s.x[v[2]], s.x[v[3]]};
    return edges(x) * e.inverse;
  }
  /// Longer than it was made, by more than round-off: shear alone is not tension.
  TAPE_HD static bool in_tension(const Element& e, const StateView& s) { return PairState::at(e.pair, s.x).d > e.rest * (1 + 1e-9); }
  TAPE_HD static Mat3 strain(const Mat3& F) { return F * F.transpose() - Mat3::Identity(); }
  TAPE_HD static Vec3 row(const Element& e, int k) {
    if (k > 0) return e.inverse.row(k - 1).transpose();
    return -e.inverse.colwise().sum().transpose();
  }
  TAPE_HD static VecN<12> bond_gradient(const Element& e, const StateView& s) {
    const Mat3 F = deformation(e, s), P = 4 * e.stiffness * strain(F) * F;
    VecN<12> g;
    for (int k = 0; k < 4; ++k) g.segment<3>(3 * k) = P * row(e, k);
    return g;
  }
  TAPE_HD Jet guard(const Element& e, const PairState& p) const { return BarrierLaw{kappa, e.rest / 2}.at(p.d, 0, e.pair.weight); }
};
static_assert(Effect<Bonds>);
}  // namespace tape
