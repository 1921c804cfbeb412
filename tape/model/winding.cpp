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

Real Winding::slope_at(Real theta) const {
  constexpr Real kRoundOff = 1e-9;  // [rad]
  const Real phi = theta - kTurn * std::floor((theta + kRoundOff) / kTurn);
  return phi >= kTurn - climb - kRoundOff ? pitch / climb : 0;
}

Real Winding::radius_at(Real theta) const {
  const Real k = std::floor(theta / kTurn);
  return radius + pitch * k + pitch / climb * std::max(0.0, theta - kTurn * k - (kTurn - climb));
}

Real Winding::arc_at(Real theta) const {
  const Real k = std::floor(theta / kTurn), flat = kTurn - climb, phi = theta - kTurn * k, b = pitch / climb;
  const Real circles = flat * (k * radius + pitch * k * (k - 1) / 2) + std::min(phi, flat) * (radius + pitch * k);
  return circles + b / 2 * (spiral_length(radius_at(theta) / b) - spiral_length(radius / b));
}

Real Winding::theta_of_arc(Real s) const {
  Real k = 0;
  while (arc_at(kTurn * (k + 1)) <= s) ++k;
  const Real flat = kTurn - climb, r = radius + pitch * k, b = pitch / climb, rest = s - arc_at(kTurn * k);
  if (rest < flat * r) return kTurn * k + rest / r;
  return kTurn * k + flat + spiral_parameter(spiral_length(r / b) + 2 * (rest - flat * r) / b) - r / b;
}

/// Arc length at x: x + cell^2/24 times the integral of dx/r^2, for the mean radius of each turn.
Real Winding::arc(Real x) const {
  if (cell == 0) return x;
  const Real slope = pitch / kTurn, theta = std::min(theta_of_arc(x), kTurn * turns);
  return x + cell * cell / (24 * slope) * std::log1p(slope * theta / radius);
}

Real Winding::wound() const {
  Real x = length();
  for (int i = 0; cell > 0 && i < 4; ++i) x -= arc(x) - length();  // contracts by (cell / 2 r)^2/6
  return x;
}

Real Winding::angle(Real x) const { return theta_of_arc(arc(x)); }

Vec2 Winding::at(Real x) const {
  const Real s = arc(x), beyond = std::max(0.0, s - length()), last = kTurn * turns;
  const Real theta = beyond > 0 ? last : theta_of_arc(s), r = radius_at(theta);
  const Real lead = std::atan2(slope_at(last), outer_radius());  // the tangent stands off the circle by this angle
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
  constexpr Real kClimb = 0.4;  // [rad] some 9 mm on the usual core: the film bends that far on its own
  return {.radius = core.outer_diameter / 2 + pitch - film.xi, .pitch = pitch, .turns = params.turns, .climb = kClimb};
}

MassProperties core_properties(const Core& core) { return ring_properties(core.inner_diameter / 2, core.outer_diameter / 2, core.height); }

AxialMass core_mass(const Core& core) {
  const MassProperties ring = core_properties(core);
  return {core.density * ring.volume, core.density * (ring.second(0, 0) + ring.second(1, 1))};
}

namespace {
struct Annulus {
  Real inner, outer;  // [m]
  explicit Annulus(const Winding& w) : inner(w.radius - (1 - w.climb / Winding::kTurn) * w.pitch / 2), outer(inner + w.turns * w.pitch) {}
};
}  // namespace

Real annulus_radius(const Winding& winding) { return Annulus(winding).outer; }

Real annulus_length(const Winding& winding) {
  const Annulus a(winding);
  return kPi * (a.outer * a.outer - a.inner * a.inner) / winding.pitch;
}

AxialMass annulus_mass(const Winding& winding, const Film& film) {
  const Annulus a(winding);
  const Real line = film.width * film.thickness * film.density;  // [kg/m]
  const Real r2 = a.inner * a.inner, R2 = a.outer * a.outer;
  return {line * annulus_length(winding), line * kPi * (R2 * R2 - r2 * r2) / (2 * winding.pitch)};
}
}  // namespace tape
