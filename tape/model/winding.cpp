#include "tape/model/winding.hpp"

#include <cmath>
#include <numbers>

namespace tape {
namespace {
constexpr Real kPi = std::numbers::pi;

/// Arc length of r = b u from u = 0 is b/2 times this. Its slope is 2 sqrt(1 + u^2).
Real spiral_length(Real u) { return u * std::sqrt(1 + u * u) + std::asinh(u); }

/// Inverse of the above by Newton's method from above, where it falls monotonically: the function is convex.
Real spiral_parameter(Real length) {
  Real u = std::sqrt(length);
  for (int i = 0; i < 50; ++i) {
    const Real next = u - (spiral_length(u) - length) / (2 * std::sqrt(1 + u * u));
    if (!(next < u)) break;
    u = next;
  }
  return u;
}
}  // namespace

Real Winding::length() const {
  const Real b = pitch / (2 * kPi);
  return b / 2 * (spiral_length(outer_radius() / b) - spiral_length(radius / b));
}

Real Winding::angle(Real s) const {
  const Real b = pitch / (2 * kPi), start = radius / b;
  return spiral_parameter(spiral_length(start) + 2 * s / b) - start;
}

Vec2 Winding::at(Real s) const {
  const Real b = pitch / (2 * kPi), last = 2 * kPi * turns, beyond = std::max(0.0, s - length());
  const Real theta = beyond > 0 ? last : angle(s), r = radius + b * theta;
  const Real lead = std::atan2(b, outer_radius());  // the tangent stands off the circle by this angle
  const Real from_top = theta - last + lead;
  return r * Vec2(std::sin(from_top), std::cos(from_top)) + beyond * Vec2::UnitX();
}

Winding make_winding(const WindingParams& params, const Core& core, const Film& film) {
  require_valid(params, "roll");
  require_valid(core, "roll.core");
  const Real pitch = params.pitch > 0 ? params.pitch : film.thickness;
  if (!(pitch > 2 * film.xi))
    throw InputError("roll.pitch = " + to_text(params.pitch) + " m" +
                     (params.pitch > 0 ? "" : " (the film's thickness, " + to_text(pitch) + " m)") + ": the layers touch (allowed: > " +
                     to_text(2 * film.xi) + " m, twice the film's xi)");
  return {.radius = core.outer_diameter / 2 + pitch - film.xi, .pitch = pitch, .turns = params.turns};
}

MassProperties core_properties(const Core& core) { return ring_properties(core.inner_diameter / 2, core.outer_diameter / 2, core.height); }

AxialMass core_mass(const Core& core) {
  const MassProperties ring = core_properties(core);
  return {core.density * ring.volume, core.density * (ring.second(0, 0) + ring.second(1, 1))};
}

Real annulus_length(const Winding& winding) {
  const Real r = winding.radius, R = winding.outer_radius();
  return kPi * (R * R - r * r) / winding.pitch;
}

AxialMass annulus_mass(const Winding& winding, const Film& film) {
  const Real line = film.width * film.thickness * film.density;  // [kg/m]
  const Real r2 = winding.radius * winding.radius, R2 = winding.outer_radius() * winding.outer_radius();
  return {line * annulus_length(winding), line * kPi * (R2 * R2 - r2 * r2) / (2 * winding.pitch)};
}
}  // namespace tape
