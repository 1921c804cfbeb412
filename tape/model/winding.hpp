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

/// Centreline of wound tape, from the hub outwards. As on a real roll each turn lies at a constant radius on the one below and climbs to
/// the next layer where it comes to the start of the tape:
///   r(theta) = radius + pitch k,  plus pitch (phi - 2 pi)/climb + pitch in the last `climb` of turn k,  theta = 2 pi k + phi.
/// With climb 2 pi it is the Archimedean spiral. At theta = 2 pi turns it goes straight on along its tangent. The axis is y; the winding
/// ends at the top and leaves it along x; the normal (backing) looks outwards.
struct Winding {
  static constexpr Real kTurn = 6.283185307179586;
  Real radius = 0;  ///< [m] where it starts
  Real pitch = 0;   ///< [m] growth of the radius in a turn
  Real turns = 0;
  Real climb = kTurn;  ///< [rad]
  int hub = -1;        ///< index into Scene::bodies; -1: none
  Real cell = 0;       ///< [m] chords of this length at rest keep it: rows stand further apart by (cell / 2 r)^2/6 along the arc

  Real outer_radius() const { return radius_at(kTurn * turns); }  ///< [m] where it ends
  Real length() const { return arc_at(kTurn * turns); }           ///< [m] of arc, exact
  Real wound() const;                                             ///< [m] of tape at rest that covers it
  Real radius_at(Real theta) const;                               ///< [m]
  Real arc_at(Real theta) const;                                  ///< [m] arc length from theta = 0
  // x [m]: place along the tape at rest
  Real angle(Real x) const;  ///< [rad] theta, x in [0, wound()]
  Vec2 at(Real x) const;     ///< [m] (x, z), the straight end included

 private:
  Real arc(Real x) const;
  Real theta_of_arc(Real s) const;
  Real slope_at(Real theta) const;
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
/// Of wound tape as an annulus from r = radius - (1 - climb/2 pi) p/2 to R = r + turns p, whose layers are `pitch` p thick; l = width
/// thickness density:
///   length pi (R^2 - r^2)/p,  mass l length,  inertia l pi (R^4 - r^4)/(2 p).
/// That is the integral over r dtheta for the mean radius of each turn; climbing makes the arc longer by some parts in a hundred thousand.
Real annulus_radius(const Winding& winding);  ///< [m] R
Real annulus_length(const Winding& winding);  ///< [m]
AxialMass annulus_mass(const Winding& winding, const Film& film);
}  // namespace tape
