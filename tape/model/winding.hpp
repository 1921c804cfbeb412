#pragma once
#include <array>
#include <string_view>

#include "tape/core/settings.hpp"
#include "tape/model/film.hpp"
#include "tape/model/mass_properties.hpp"

namespace tape {
/// The ring that a tape is wound on. Defaults: the 38-mm core of 19-mm vinyl tape.
struct Core {
  Real inner_diameter = 0.038;
  Real outer_diameter = 0.0422;
  Real height = 0.020;
  Real density = 950;
  int sides = 96;
  template <class F>
  void fields(F&& f) {
    f("inner_diameter", inner_diameter, "m", Range::above(0, 1), "bore of the core; below outer_diameter");
    f("outer_diameter", outer_diameter, "m", Range::above(0, 1), "of the surface that the tape is wound on");
    f("height", height, "m", Range::above(0, 1), "of the core along its axis");
    f("density", density, "kg/m^3", Range::above(0, 3e4), "mass density of the core");
    f("sides", sides, "1", Range::closed(3, 2000),
      "of the inscribed polygon that stands for the circle; mass and inertia are those of the circle");
  }
};

enum class Sense { left, right };
constexpr auto enum_names(Sense) { return std::array<std::string_view, 2>{"left", "right"}; }

struct WindingParams {
  Real turns = 2;
  Real free_length = 0.05;
  Sense sense = Sense::left;
  Real pitch = 0;
  template <class F>
  void fields(F&& f) {
    f("turns", turns, "1", Range::above(0, 1000), "turns of tape around the core");
    f("free_length", free_length, "m", Range::closed(0, 100), "tape that stands off the roll, straight along its tangent");
    f("sense", sense, "", Range::any(), "side to which the free end leaves the top of the roll, with x to the right and z up");
    f("pitch", pitch, "m", Range::closed(0, 0.01), "distance from layer to layer, above twice the film's xi; 0: thickness of the film");
  }
};

/// Centreline of wound tape: from the hub outwards the Archimedean spiral
///   r(theta) = radius + pitch theta / (2 pi),  theta in [0, 2 pi turns],
/// then straight on along its tangent. The axis is y; the spiral ends at the top and leaves it along x; the normal (backing) looks
/// outwards.
struct Winding {
  Real radius = 0;  ///< [m] where the spiral starts
  Real pitch = 0;   ///< [m] growth of the radius in a turn
  Real turns = 0;
  int hub = -1;  ///< index into Scene::bodies; -1: none

  Real outer_radius() const { return radius + turns * pitch; }  ///< [m] where the spiral ends
  Real length() const;                                          ///< [m] of the spiral, exact
  Real angle(Real s) const;                                     ///< [rad] theta at arc length s [m] in [0, length()]
  Vec2 at(Real s) const;                                        ///< [m] (x, z) of the point at arc length s [m], the straight end included
};

/// The innermost layer has the same gap to the hub as the layers to each other, pitch - 2 xi; the hub has no thickness in contact:
///   radius = outer_diameter/2 + pitch - xi.
/// @throws InputError if a setting is out of range, or layers of this pitch touch
Winding make_winding(const WindingParams& params, const Core& core, const Film& film);

/// About the axis of a roll.
struct AxialMass {
  Real mass = 0;     ///< [kg]
  Real inertia = 0;  ///< [kg m^2]
};
/// Of the core as an exact ring.
MassProperties core_properties(const Core& core);
AxialMass core_mass(const Core& core);
/// Of wound tape as an annulus from `radius` r to `outer_radius` R whose layers stand `pitch` p apart; l = width thickness density:
///   length pi (R^2 - r^2)/p,  mass l length,  inertia l pi (R^4 - r^4)/(2 p).
/// That is the integral over r dtheta; the arc length of the spiral exceeds it by half of (p / 2 pi r)^2, one part in a million.
Real annulus_length(const Winding& winding);
AxialMass annulus_mass(const Winding& winding, const Film& film);
}  // namespace tape
