#pragma once
#include "tape/effects/effect.hpp"

namespace tape {
struct Jet;
struct PairState;

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
  Real dhat;  ///< [m]

  static constexpr AdhesionLaw of_law = AdhesionLaw::bond;
  static std::string needed(const Scene& scene, const Params&) { return scene.uses(of_law) ? "interfaces" : ""; }
  static Bonds build(const Scene& scene, const Assembly&, const Params&, std::vector<Element>&) { return {{}, scene.dhat()}; }
  TAPE_HD inline Element recall(const Memory& m, const ContactPair& pair, const StateView& s) const;

  TAPE_HD Stencil<4> stencil(int i) const {
    const int(&v)[4] = elements[i].pair.v;
    return {{v[0], v[1], v[2], v[3]}};
  }
  TAPE_HD bool active(const StateView&, int i) const { return elements[i].stiffness > 0; }
  TAPE_HD inline Real energy(const StateView& s, int i) const;
  TAPE_HD inline VecN<12> gradient(const StateView& s, int i) const;
  /// With b_k the rows of D_b^-1 (b_0 minus their sum), f_k = F b_k and S = F F^T - I the blocks are
  ///   4 V kappa_b [(f_k.f_l) I + f_l f_k^T + (b_k.b_l) S];
  /// the first two make a square, so that `projected` need only clamp S.
  TAPE_HD inline MatN<12, 12> hessian(const StateView& s, int i, HessianMode mode) const;

  /// Bonds form where the vertex stands over the face, within reach and not pressed below the floor.
  TAPE_HD inline bool begin(const ContactPair& pair, const StateView& s, Memory& out) const;
  TAPE_HD bool renew(const StateView&, int, Memory& m) const { return m.cooldown == 0 || --m.cooldown > 0; }
  /// Force on the vertex over the break force, in tension; else 0.
  TAPE_HD inline Real load(const StateView& s, int i) const;
  /// The end of the step is the first that the cooldown counts.
  TAPE_HD void let_go(const StateView& s, int i, Memory& m) const { m.cooldown = s.adhesion[elements[i].pair.interface].bond.cooldown + 1; }
  /// Near its release the force of a bond must be known to a twentieth, or errors of the solver release it.
  TAPE_HD inline Real accuracy_to_judge(const StateView& s, int i) const;
  TAPE_HD inline Real slack(const StateView& s, int i) const;
  TAPE_HD inline AdhesiveForce force(const StateView& s, int i) const;

 private:
  TAPE_HD static inline Mat3 edges(const Vec3 (&x)[4]);
  TAPE_HD static inline Mat3 deformation(const Element& e, const StateView& s);
  /// Longer than it was made, by more than round-off: shear alone is not tension.
  TAPE_HD static inline bool in_tension(const Element& e, const StateView& s);
  TAPE_HD static inline Mat3 strain(const Mat3& F);
  TAPE_HD static inline Vec3 row(const Element& e, int k);
  TAPE_HD static inline VecN<12> bond_gradient(const Element& e, const StateView& s);
  TAPE_HD inline Jet guard(const Element& e, const PairState& p) const;
  /// [m] by which an unloaded bond is stretched where it breaks, by its stiffness 8 V kappa_b/h^2.
  TAPE_HD inline Real stretch_to_break(const StateView& s, int i) const;
};
static_assert(Effect<Bonds>);
}  // namespace tape
