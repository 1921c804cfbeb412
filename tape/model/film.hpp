#pragma once
#include <string>

#include "tape/core/settings.hpp"

namespace tape {
/// A tape as it comes off the roll. Files in data/tapes/ hold one each, with the origin of every number.
struct Film {
  std::string name;             ///< file name without extension
  Real width = 0.019;           ///< [m]
  Real thickness = 1.8e-4;      ///< [m]     full film, for mass and stiffness
  Real density = 1300;          ///< [kg/m^3]
  Real membrane_modulus = 5e7;  ///< [Pa]
  Real bending_modulus = 5e7;   ///< [Pa]
  Real poisson = 0.45;          ///< [1]
  Real xi = 4.5e-5;             ///< [m]     half-thickness in contact
  Real dhat = 1.8e-4;           ///< [m]     activation distance this film asks for
  template <class F>
  void fields(F&& f) {
    f("width", width, "m", Range::above(0, 1), "width of the tape");
    f("thickness", thickness, "m", Range::above(0, 0.01), "full thickness of the film: mass and stiffness");
    f("density", density, "kg/m^3", Range::above(0, 3e4), "mass density");
    f("membrane_modulus", membrane_modulus, "Pa", Range::positive(), "Young's modulus in stretch");
    f("bending_modulus", bending_modulus, "Pa", Range::non_negative(), "Young's modulus in bending; 0: no bending resistance");
    f("poisson", poisson, "1", Range{.low = 0, .high = 0.5, .open_high = true}, "Poisson's ratio");
    f("xi", xi, "m", Range::non_negative(), "contact half-thickness");
    f("dhat", dhat, "m", Range::positive(), "contact activation distance of this film, used where the scene gives none");
  }
  /// Plate stiffness D = E h^3 / (12 (1 - nu^2)) [N m].
  Real plate_stiffness() const { return bending_modulus * thickness * thickness * thickness / (12 * (1 - poisson * poisson)); }
};
}  // namespace tape
