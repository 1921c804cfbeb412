#pragma once
#include <array>
#include <string_view>

#include "tape/core/settings.hpp"

namespace tape {
/// How an interface sticks.
enum class AdhesionLaw { none, per_pair, per_area, bond };
constexpr auto enum_names(AdhesionLaw) { return std::array<std::string_view, 4>{"none", "per_pair", "per_area", "bond"}; }

/// What tangential slip is measured from.
enum class SlipFrom { step, bonding };
constexpr auto enum_names(SlipFrom) { return std::array<std::string_view, 2>{"step", "bonding"}; }

/// Faces of a strip: its normal points out of the backing. What adheres to a body adheres to both.
enum class Face : int { backing, sticky };
constexpr auto enum_names(Face) { return std::array<std::string_view, 2>{"backing", "sticky"}; }

/// The cohesive law of the paper, eq. 2 and 3: newtons per vertex-triangle pair, so that the answer depends on the mesh.
struct PairCohesion {
  Real cn = 1;
  Real ct = 1;
  Real work = 1;
  Real eta = 100;
  Real gamma = 1;
  Real p0 = 0;
  Real beta0 = 0;
  Real drop = 0.5;
  SlipFrom slip = SlipFrom::step;
  template <class F>
  void fields(F&& f) {
    f("cn", cn, "N", Range::positive(), "C_n, resistance of a pair to opening");
    f("ct", ct, "N", Range::non_negative(), "C_t, resistance of a pair to sliding");
    f("work", work, "1", Range::non_negative(), "W, retention: what opening and slip must exceed to debond");
    f("eta", eta, "s", Range::positive(), "debonding is slower with a larger eta");
    f("gamma", gamma, "1/s", Range::non_negative(), "how fast compression engages");
    f("p0", p0, "", Range::non_negative(), "compression below which full engagement does not grow, as p of the paper");
    f("beta0", beta0, "1", Range::closed(0, 1), "engagement of a pair that is new in the contact band");
    f("drop", drop, "1", Range::closed(0.5, 100),
      "opening d - d* at which a pair is dropped, in units of dhat; 0.5 is the edge of the band");
    f("slip", slip, "", Range::any(), "slip since the start of the step (the paper: sticking creeps), or since bonding");
  }
};

/// Cohesive zone by area, which does not depend on the mesh: traction rises linearly with the opening to `strength`, then falls
/// linearly to nothing, and the area under it is `toughness`.
struct AreaCohesion {
  Real strength = 1e5;
  Real toughness = 10;
  Real peak = 0.1;
  Real shear = 1;
  Real rest = 0.5;
  Real reach = 0.5;
  template <class F>
  void fields(F&& f) {
    f("strength", strength, "Pa", Range::positive(), "largest traction");
    f("toughness", toughness, "J/m^2", Range::positive(), "work that separates a unit of area for good");
    f("peak", peak, "1", Range::above(0, 0.9), "opening at the largest traction, in units of the final one, 2 toughness/strength");
    f("shear", shear, "1", Range::non_negative(), "r, weight of squared slip against squared opening");
    f("rest", rest, "1", Range::above(0, 1), "gap from which the opening counts, in units of dhat");
    f("reach", reach, "1", Range::above(0, 1), "gap up to which area sticks, in units of dhat; up to `rest` it must be pressed together");
  }
  TAPE_HD Real final_opening() const { return 2 * toughness / strength; }  ///< [m]
};

/// Releasable bonds of the paper, eq. 4: each replaces contact, friction and cohesion of a vertex-triangle pair.
struct BondLaw {
  Real kappa_b = 1e6;
  Real break_force = 0.5;
  Real reach = 1;
  Real floor = 0.5;
  int cooldown = 3;
  template <class F>
  void fields(F&& f) {
    f("kappa_b", kappa_b, "Pa", Range::positive(), "stiffness of a bond");
    f("break_force", break_force, "N", Range::positive(), "force on the vertex at which a bond in tension is released");
    f("bond_reach", reach, "1", Range::closed(0.5, 1), "gap up to which a pair bonds, in units of dhat");
    f("bond_floor", floor, "1", Range::closed(0, 0.9), "gap from which on a pair bonds, in units of dhat: what is pressed hard does not");
    f("cooldown", cooldown, "steps", Range::closed(0, 1000), "for how long a released pair does not bond again");
  }
};

/// Adhesion between two materials, `first` and `second` in the order of ContactPair::interface.
struct Adhesion {
  AdhesionLaw law = AdhesionLaw::none;
  bool sticks[2][2] = {};  ///< [face of the first][face of the second]: which faces adhere to which
  PairCohesion pair;
  AreaCohesion area;
  BondLaw bond;
};
}  // namespace tape
