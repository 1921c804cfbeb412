#pragma once
#include "tape/effects/effect.hpp"

namespace tape {
/// Second-order form of an energy of how one rigid body stands to another, at one place: E = energy + force.xi + xi.stiffness xi / 2, with
/// xi = (displacement [m], rotation [rad]).
struct PlaceForm {
  Real energy = 0;                            ///< [J]
  VecN<6> force = VecN<6>::Zero();            ///< [N, N m]
  MatN<6, 6> stiffness = MatN<6, 6>::Zero();  ///< [N/m, N, N m]; positive semidefinite
  /// In axes that are turned by R to these.
  PlaceForm seen_from(const Mat3& R) const {
    MatN<6, 6> turn = MatN<6, 6>::Zero();
    turn.topLeftCorner<3, 3>() = turn.bottomRightCorner<3, 3>() = R.transpose();
    return {energy, turn * force, turn * stiffness * turn.transpose()};
  }
  TAPE_HD PlaceForm operator+(const PlaceForm& o) const { return {energy + o.energy, force + o.force, stiffness + o.stiffness}; }
};

/// What holds the cluster of a roll on its hub, and off it, while it rests there: instead of all their pairs their second-order form, of
///   xi = (R_h^T (t_c + R_c a - t_h), axial(M)/2),   M = R_h^T R_c Q^T,
/// with poses (R_h, t_h) of the hub and (R_c, t_c) of the cluster, a the point of the cluster that was the hub's centre when it came to
/// rest, and Q its rotation then, in the hub's frame. `projected` drops the curvature of xi.  README.md of reduction/ says when.
struct Seat {
  static constexpr std::string_view name = "seat";
  static constexpr bool on_blocks = true;
  using Params = NoParams;
  struct Element {
    int hub, cluster;              ///< bodies
    int hub_block, cluster_block;  ///< first of their two
    Vec3 arm;                      ///< [m] a, in the cluster's frame
    Mat3 turn;                     ///< Q
    PlaceForm form;
  };
  Span<const Element> elements;

  static std::string needed(const Scene& scene, const Params&) {
    if (scene.cluster.seat == 0) return "";
    for (const Strip& strip : scene.strips)
      if (scene.reduces(strip)) return "model";
    return "";
  }
  /// Elements come and go with the state.
  static Seat build(const Scene&, const Assembly&, const Params&, std::vector<Element>&) { return {}; }
  TAPE_HD Stencil<4> stencil(int i) const {
    const Element& e = elements[i];
    return {{e.hub_block, e.hub_block + 1, e.cluster_block, e.cluster_block + 1}};
  }
  TAPE_HD inline Real energy(const StateView& s, int i) const;
  TAPE_HD inline VecN<12> gradient(const StateView& s, int i) const;
  TAPE_HD inline MatN<12, 12> hessian(const StateView& s, int i, HessianMode mode) const;

 private:
  struct At;
  TAPE_HD inline At at(const StateView& s, int i) const;
};
static_assert(Effect<Seat>);
}  // namespace tape
