#include "tape/model/winding.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <string>

using namespace tape;

namespace {
constexpr Real kPi = std::numbers::pi;
const Film kVinyl{.name = "vinyl_19mm"};
/// As the reference table winds it: the centreline starts at the core's outer radius, without regard to thickness.
Winding on_the_core(Real turns, Real pitch = 1.8e-4) { return {.radius = 0.0211, .pitch = pitch, .turns = turns}; }

/// Integral of f over [a, b], Simpson's rule.
template <class F>
Real integral(F&& f, Real a, Real b, int intervals) {
  Real sum = f(a) + f(b);
  for (int i = 1; i < intervals; ++i) sum += (i % 2 == 1 ? 4 : 2) * f(a + (b - a) * i / intervals);
  return sum * (b - a) / (3 * intervals);
}
/// [m] from theta = a to b along r = radius + pitch theta/(2 pi).
Real arc(const Winding& w, Real a, Real b, int intervals) {
  const Real slope = w.pitch / (2 * kPi);
  return integral([&](Real theta) { return std::hypot(w.radius + slope * theta, slope); }, a, b, intervals);
}
std::string refusal(const WindingParams& params, const Core& core, const Film& film) {
  try {
    make_winding(params, core, film);
  } catch (const InputError& e) {
    return e.what();
  }
  return "";
}
}  // namespace

TEST(Winding, HasTheRadiusLengthMassAndInertiaOfTheReferenceTable) {  // checks.md, part 6, to the digits given there
  const struct {
    Real turns, outer_mm, length_mm, mass_g, inertia, last_digit;
  } rows[] = {{2, 21.460, 267.412, 6.215432, 2.56463913e-6, 1e-14},
              {8, 22.540, 1096.793, 9.902858, 4.35042834e-6, 1e-14},
              {16, 23.980, 2265.968, 15.101010, 7.16546708e-6, 1e-14},
              {32, 26.860, 4821.465, 26.462751, 1.45307152e-5, 1e-13}};
  const AxialMass core = core_mass({});
  EXPECT_NEAR(1e3 * core.mass, 5.0265, 0.5e-4);
  for (const auto& row : rows) {
    const Winding w = on_the_core(row.turns);
    const AxialMass tape = annulus_mass(w, kVinyl);
    EXPECT_NEAR(1e3 * annulus_radius(w), row.outer_mm, 0.5e-3) << row.turns;
    EXPECT_NEAR(1e3 * annulus_length(w), row.length_mm, 0.5e-3) << row.turns;
    EXPECT_NEAR(1e3 * (core.mass + tape.mass), row.mass_g, 0.5e-6) << row.turns;
    EXPECT_NEAR(core.inertia + tape.inertia, row.inertia, 0.5 * row.last_digit) << row.turns;
  }
  EXPECT_NEAR(1e3 * annulus_length(on_the_core(32, 3.6e-4)), 5400.5, 0.05);
  EXPECT_NEAR(1e3 * on_the_core(32, 3.6e-4).outer_radius(), 32.62, 0.5e-2);
}

TEST(Winding, LengthIsTheIntegralOfItsArcAndAnAngleBelongsToEachPartOfIt) {
  for (Real turns : {0.3, 2.0, 32.0}) {
    const Winding w = on_the_core(turns);
    EXPECT_NEAR(w.length(), arc(w, 0, 2 * kPi * turns, 2000), 1e-12 * w.length()) << turns;
    for (Real part : {0.0, 1e-3, 0.4, 0.9, 1.0}) {
      const Real s = part * w.length(), theta = w.angle(s);
      EXPECT_NEAR(arc(w, 0, theta, 2000), s, 1e-12 * w.length()) << turns << " turns at " << part;
    }
  }
}

TEST(Winding, ArcIsLongerThanTheAnnulusByWhatTheRadiusGrows) {
  const Winding w = on_the_core(2);
  const Real slope = w.pitch / (2 * kPi);  // sqrt(r^2 + b^2) = r + b^2/(2 r) + ...
  const Real excess = integral([&](Real theta) { return slope * slope / (2 * (w.radius + slope * theta)); }, 0, 4 * kPi, 2000);
  EXPECT_NEAR(w.length() - annulus_length(w), excess, 1e-4 * excess);
  const Real line = kVinyl.width * kVinyl.thickness * kVinyl.density;
  const Real inertia = integral([&](Real theta) { return line * std::pow(w.radius + slope * theta, 3); }, 0, 4 * kPi, 2000);
  EXPECT_NEAR(annulus_mass(w, kVinyl).inertia, inertia, 1e-12 * inertia) << "the integral of r^2 dm, dm = line r dtheta";
}

TEST(Winding, CentrelineIsTheSpiralThatEndsAtTheTop) {
  const Winding w = on_the_core(2.25);
  const Real slope = w.pitch / (2 * kPi);
  const Real last = 2 * kPi * w.turns, start = std::atan(slope / w.outer_radius()) - last;  // from the top, clockwise
  for (Real part : {0.0, 0.11, 0.5, 0.77, 1.0}) {
    const Real theta = w.angle(part * w.length()), r = w.radius + slope * theta;
    const Vec2 expected = r * Vec2(std::sin(start + theta), std::cos(start + theta));
    EXPECT_LT((w.at(part * w.length()) - expected).norm(), 1e-15) << part;
  }
  EXPECT_NEAR(w.at(0).norm(), w.radius, 1e-15);
  EXPECT_NEAR(w.at(w.length()).norm(), w.outer_radius(), 1e-15);
}

TEST(Winding, TurnsAreCirclesJoinedByClimbs) {
  Winding w = on_the_core(3);
  w.climb = 0.4;
  EXPECT_EQ(w.radius_at(0), w.radius);
  for (int k = 0; k < 3; ++k) {
    EXPECT_NEAR(w.radius_at(2 * kPi * k + 1), w.radius + k * w.pitch, 1e-16);
    EXPECT_NEAR(w.radius_at(2 * kPi * (k + 1) - 0.2), w.radius + (k + 0.5) * w.pitch, 1e-16);
  }
  Real sum = 0;  // circles, and climbs by Simpson's rule
  for (int k = 0; k < 3; ++k) {
    const Real r = w.radius + k * w.pitch, slope = w.pitch / w.climb;
    sum += (2 * kPi - w.climb) * r + integral([&](Real phi) { return std::hypot(r + slope * phi, slope); }, 0, w.climb, 200);
  }
  EXPECT_NEAR(w.length(), sum, 1e-12);
  EXPECT_NEAR(w.length(), annulus_length(w), 5e-5 * sum);
  for (Real part : {0.0, 0.2, 0.333, 0.9, 1.0}) EXPECT_NEAR(w.arc_at(w.angle(part * w.length())), part * w.length(), 1e-12) << part;
  EXPECT_LT((w.at(w.length()) - Vec2(0, w.outer_radius())).norm(), 1e-14);
  EXPECT_LT((w.at(w.length() + 0.01) - Vec2(0.01, w.outer_radius())).norm(), 1e-14);
}

TEST(Winding, TapeGoesOnStraightAlongTheTangent) {
  const Winding w = on_the_core(8);
  const Vec2 end = w.at(w.length());
  for (Real beyond : {1e-9, 1e-3, 0.1}) EXPECT_LT((w.at(w.length() + beyond) - end - Vec2(beyond, 0)).norm(), 1e-14) << beyond;
  const Real h = 1e-6, radius = w.outer_radius();  // behind the end the curve falls away by h^2 / (2 radius)
  EXPECT_LT((w.at(w.length() - h) - end - Vec2(-h, -h * h / (2 * radius))).norm(), 1e-14);
}

TEST(Winding, IsParametrisedByItsArcLength) {
  const Winding w = on_the_core(3);
  const Real h = 1e-6;
  for (Real part : {0.1, 0.5, 0.9})
    EXPECT_NEAR((w.at(part * w.length() + h) - w.at(part * w.length() - h)).norm() / (2 * h), 1, 1e-8) << part;
}

TEST(Winding, PitchIsTheFilmsThicknessAndTheHubIsAsFarAsTheNextLayer) {
  const Winding w = make_winding({.turns = 32}, {}, kVinyl);
  EXPECT_EQ(w.pitch, 1.8e-4);
  EXPECT_NEAR(w.radius, 0.021235, 1e-17);  // 21.1 mm + xi 0.045 + gap 0.09
  EXPECT_NEAR(w.outer_radius(), 0.026995, 1e-16);
  Film authors = kVinyl;  // the paper's rolls: R_hub + t + dhat/2, for layers that rest dhat/2 beyond contact
  authors.xi = 9e-5;
  EXPECT_NEAR(make_winding({.pitch = 2.7e-4}, {}, authors).radius, 0.0211 + 9e-5 + 9e-5, 1e-17);
}

TEST(Winding, SettingsThatMakeNoRollAreRefusedByName) {
  EXPECT_EQ(refusal({}, {}, kVinyl), "");
  EXPECT_NE(refusal({.turns = 0}, {}, kVinyl).find("roll.turns"), std::string::npos);
  EXPECT_NE(refusal({.turns = std::numeric_limits<Real>::quiet_NaN()}, {}, kVinyl).find("roll.turns"), std::string::npos);
  EXPECT_NE(refusal({.free_length = -0.1}, {}, kVinyl).find("roll.free_length"), std::string::npos);
  EXPECT_NE(refusal({}, {.sides = 2}, kVinyl).find("roll.core.sides"), std::string::npos);
  EXPECT_NE(refusal({.pitch = 9e-5}, {}, kVinyl).find("roll.pitch = 9e-05 m: the layers touch"), std::string::npos);
  EXPECT_EQ(refusal({.pitch = 9.1e-5}, {}, kVinyl), "");
  Film thick = kVinyl;
  thick.xi = 1e-4;
  EXPECT_NE(refusal({}, {}, thick).find("the film's thickness"), std::string::npos);
}
