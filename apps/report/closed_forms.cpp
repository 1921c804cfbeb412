#include "apps/report/closed_forms.hpp"

#include <cmath>
#include <numbers>

#include "tape/core/settings.hpp"

namespace tape::report {
namespace {
constexpr int kSteps = 4000;

/// Curve from the tip (u = 0) towards the clamp (u = 1), in units of the length.
struct Curve {
  Real theta = 0, slope = 0, x = 0, drop = 0;
};
Curve operator+(const Curve& a, const Curve& b) { return {a.theta + b.theta, a.slope + b.slope, a.x + b.x, a.drop + b.drop}; }
Curve operator*(Real k, const Curve& a) { return {k * a.theta, k * a.slope, k * a.x, k * a.drop}; }

/// d/du of the curve: theta'' = -gamma u cos theta.
Curve rate(Real gamma, Real u, const Curve& c) { return {c.slope, -gamma * u * std::cos(c.theta), std::cos(c.theta), std::sin(c.theta)}; }

/// The curve at the clamp, or at the first point where its angle has become negative.
Curve shoot(Real gamma, Real tip_angle) {
  constexpr Real h = 1.0 / kSteps;
  Curve c{.theta = tip_angle};
  for (int i = 0; i < kSteps && c.theta >= 0; ++i) {
    const Real u = i * h;
    const Curve k1 = rate(gamma, u, c);
    const Curve k2 = rate(gamma, u + h / 2, c + (h / 2) * k1);
    const Curve k3 = rate(gamma, u + h / 2, c + (h / 2) * k2);
    const Curve k4 = rate(gamma, u + h, c + h * k3);
    c = c + (h / 6) * (k1 + 2 * k2 + 2 * k3 + k4);
  }
  return c;
}
}  // namespace

ElasticaTip heavy_elastica(Real gamma) {
  if (!(gamma >= 0 && gamma <= 1000)) throw SettingsError("gamma", to_text(gamma), Range::closed(0, 1000).text());
  // The larger the tip's angle, the later the curve gets back to the horizontal; the first branch does so at the clamp.
  Real low = 0, high = std::numbers::pi / 2;
  while (true) {
    const Real middle = (low + high) / 2;
    if (middle == low || middle == high) break;
    (shoot(gamma, middle).theta < 0 ? low : high) = middle;
  }
  const Curve clamp = shoot(gamma, high);
  return {clamp.drop, clamp.x, high};
}

Real capstan_ratio(Real mu, Real angle) { return std::exp(mu * angle); }

Real peel_force(Real toughness, Real angle, Real stretch) {
  const Real turn = 1 - std::cos(angle), relative = 2 * toughness / stretch;
  return stretch * relative / (turn + std::sqrt(turn * turn + relative));
}
}  // namespace tape::report
