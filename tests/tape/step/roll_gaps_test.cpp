#include "tape/step/roll_gaps.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <regex>

#include "tape/model/roll.hpp"
#include "tape/model/strip_mesh.hpp"
#include "tape/step/world.hpp"
#include "tests/support/simulation.hpp"
using namespace tape;

namespace {
constexpr Real kPi = std::numbers::pi, kInfinity = std::numeric_limits<Real>::infinity();
constexpr Real kRadius = 0.021235, kPitch = 1.8e-4, kXi = 4.5e-5, kDhat = 1.8e-4, kCore = 0.0211;  // [m]
constexpr int kSides = 96, kColumns = 7;

/// An Archimedean spiral with rows at equal arc length: its section is easily written down.
Setup roll_setup(const WindingParams& params, Real cell_length = 0) {
  Setup setup;
  setup.scene.films = {test::vinyl()};
  Strip strip;
  strip.mesh.cell_length = cell_length;
  wind(setup.scene, strip, params, {}, {});
  strip.winding->climb = Winding::kTurn, strip.winding->cell = 0;
  strip.mesh.length = strip.winding->length() + params.free_length;
  setup.scene.strips = {strip};
  return setup;
}
RollGaps gaps_of(const World& world) { return roll_gaps(world.setup.scene, world.assembly, world.surface, world.assembly.x, 0); }

/// A roll seen along its axis. Its surfaces are prisms that overlap along the axis, so distances in this plane are the true ones.
class Section {
 public:
  /// The spiral by Runge-Kutta steps of d theta/ds = 1 / sqrt(r^2 + b^2), a row every `cell` m, and the straight end.
  Section(Real turns, Real free_length) {
    const Real b = kPitch / (2 * kPi), last = 2 * kPi * turns;
    const auto rate = [&](Real theta) { return 1 / std::hypot(kRadius + b * theta, b); };
    const auto next = [&](Real theta, Real ds) {
      const Real k1 = rate(theta), k2 = rate(theta + ds / 2 * k1), k3 = rate(theta + ds / 2 * k2), k4 = rate(theta + ds * k3);
      return theta + ds / 6 * (k1 + 2 * k2 + 2 * k3 + k4);
    };
    const Real u0 = kRadius / b, u1 = u0 + last;
    const auto g = [](Real u) { return u * std::sqrt(1 + u * u) + std::asinh(u); };
    const Real wound = b / 2 * (g(u1) - g(u0)), length = wound + free_length, cells = std::round(length / (0.019 / 6));
    const auto point = [&](Real theta) {
      const Real angle = theta - last + std::atan(b / (kRadius + b * last));
      return Vec2((kRadius + b * theta) * Vec2(std::sin(angle), std::cos(angle)));
    };
    Real theta = 0;
    for (int row = 0; row <= static_cast<int>(cells); ++row) {
      const Real s = length * row / cells;
      if (s <= wound) {
        theta_.push_back(theta);
        x_.push_back(point(theta));
        theta = next(next(theta, length / cells / 2), length / cells / 2);
      } else {
        x_.push_back(point(last) + Vec2(s - wound, 0));
      }
    }
    for (int k = 0; k <= kSides; ++k) hub_.push_back(kCore * Vec2(std::cos(2 * kPi * k / kSides), std::sin(2 * kPi * k / kSides)));
  }
  int wound_rows() const { return static_cast<int>(theta_.size()); }
  bool first_turn(int row) const { return theta_[row] < 2 * kPi; }
  /// [m] gap of a wound row to the hub or to the layer below, whichever it lies on.
  Real below(int row) const {
    if (first_turn(row)) return to_line(x_[row], hub_, 0, kSides) - kXi;
    return to_line(x_[row], x_, 0, row - 20) - 2 * kXi;  // 20 of 42 rows a turn: not the row's own layer
  }
  Real smallest() const {
    Real gap = kInfinity;
    for (int row = 0; row + 20 < static_cast<int>(x_.size()); ++row) {
      gap = std::min(gap, to_line(x_[row], x_, row + 20, static_cast<int>(x_.size()) - 1) - 2 * kXi);
      gap = std::min(gap, to_line(x_[row + 20], x_, 0, row) - 2 * kXi);
    }
    for (const Vec2& p : x_) gap = std::min(gap, to_line(p, hub_, 0, kSides) - kXi);
    for (const Vec2& p : hub_) gap = std::min(gap, to_line(p, x_, 0, static_cast<int>(x_.size()) - 1) - kXi);
    return gap;
  }

 private:
  /// [m] from p to the segments between points `first` and `last` of a line; those that are far off are passed over.
  static Real to_line(const Vec2& p, const std::vector<Vec2>& line, int first, int last) {
    Real d = kInfinity;
    for (int i = first; i < last; ++i) {
      const Vec2 &a = line[i], e = line[i + 1] - a;
      const Real t = std::clamp((p - a).dot(e) / e.squaredNorm(), 0.0, 1.0);
      d = std::min(d, (p - a - t * e).norm());
    }
    return d;
  }
  std::vector<Real> theta_;  // of wound rows
  std::vector<Vec2> x_, hub_;
};

std::string refusal(const Setup& setup) {
  try {
    World::build(setup);
  } catch (const InputError& e) {
    return e.what();
  }
  return "";
}
}  // namespace

TEST(RollGaps, AreTheTrueDistancesOfTheSection) {
  for (Real turns : {2.0, 8.0, 32.0}) {
    const Section section(turns, 0.05);
    const RollGaps gaps = gaps_of(World::build(roll_setup({.turns = turns, .free_length = 0.05})));
    EXPECT_NEAR(gaps.smallest, section.smallest(), 1e-12) << turns;
    GapsBelow hub, layers;
    for (int row = 0; row < section.wound_rows(); ++row) {
      GapsBelow& of = section.first_turn(row) ? hub : layers;
      of.largest = std::max(of.largest, section.below(row));
      of.vertices += kColumns;
      of.apart += section.below(row) > kDhat ? kColumns : 0;
    }
    EXPECT_NEAR(gaps.hub.largest, hub.largest, 1e-12) << turns;
    EXPECT_NEAR(gaps.layers.largest, layers.largest, 1e-12) << turns;
    EXPECT_EQ(gaps.hub.vertices, hub.vertices) << turns;
    EXPECT_EQ(gaps.layers.vertices, layers.vertices) << turns;
    EXPECT_EQ(gaps.hub.apart, hub.apart) << turns;
    EXPECT_EQ(gaps.layers.apart, 0) << turns;
    // For cells of 3.17 mm another program found 32 to 149 um: the gap of 90 um less and more the sagitta of 59 um.
    EXPECT_NEAR(gaps.smallest, 32e-6, 1e-6) << turns;
    EXPECT_NEAR(gaps.layers.largest, 149e-6, 1e-6) << turns;
  }
}

TEST(RollGaps, AreWithinTheSagittaOfTheirChordsForFinerCells) {  // another program: 64 to 111 and 76 to 102 um
  for (Real cell : {0.019 / 9, 0.019 / 12}) {
    const World world = World::build(roll_setup({.turns = 8}, cell));
    const RollGaps gaps = gaps_of(world);
    const Real whole = cell_length(world.setup.scene.strips[0].mesh, 0.019);  // nearly `cell`: they fill the strip
    const Real sagitta = kRadius * (1 - std::cos(whole / (2 * kRadius)));
    EXPECT_GT(gaps.smallest, 9e-5 - 1.01 * sagitta);
    EXPECT_LT(gaps.smallest, 9e-5 - 0.9 * sagitta);
    EXPECT_LT(gaps.layers.largest, 9e-5 + sagitta);
    EXPECT_GT(gaps.layers.largest, 9e-5 + 0.7 * sagitta);
  }
}

TEST(RollGaps, ARollStartsSoundInEitherSense) {
  for (Sense sense : {Sense::left, Sense::right})
    for (Real turns : {0.4, 2.0, 8.0}) EXPECT_EQ(refusal(roll_setup({.turns = turns, .sense = sense})), "") << turns;
}

TEST(RollGaps, LayersBeyondTheBandAreCounted) {
  const RollGaps gaps = gaps_of(World::build(roll_setup({.turns = 2, .pitch = 4e-4})));  // gaps of 310 um less 59 um at least
  EXPECT_EQ(gaps.layers.apart, gaps.layers.vertices);
  EXPECT_EQ(gaps.hub.apart, gaps.hub.vertices);
  EXPECT_GT(gaps.layers.vertices, 0);
}

TEST(RollGaps, ATurnTooCloseToTheHubIsNamedWithItsDistanceAndTheCure) {
  // gap 40 um between spiral and hub, less up to 59 um of sagitta: the first chord touches, but crosses nothing
  const std::string message = refusal(roll_setup({.turns = 2, .pitch = 1.3e-4}));
  std::smatch match;
  ASSERT_TRUE(std::regex_search(message, match, std::regex("roll 'tape': turn 0\\.0\\d* \\(row 0\\) and the hub are (\\S+) m apart")))
      << message;
  const Real distance = std::stod(match[1]), sagitta = kRadius * (1 - std::cos(0.019 / 12 / kRadius));
  EXPECT_NEAR(distance, 1.3e-4 - kXi - sagitta, 3e-6) << "the hub's vertices stand within 1.4 mm of the chord's middle";
  for (const char* words : {"half-thicknesses together are 4.5e-05 m", "raise roll.pitch (0.00013 m)", "strip.cell_length (0.0031"})
    EXPECT_NE(message.find(words), std::string::npos) << words << "\n" << message;
}

TEST(RollGaps, LayersTooCloseToEachOtherAreNamedByTurnAndRow) {
  for (const auto& [pitch, words] : {std::pair{1.3e-4, "apart"}, std::pair{9.5e-5, "m apart"}, std::pair{3e-5, "cross"}}) {
    tape::Setup setup = roll_setup({.turns = 2.5});
    setup.scene.strips[0].winding->radius += 1e-4;  // clear of the hub
    setup.scene.strips[0].winding->pitch = pitch;
    const std::string message = refusal(setup);
    std::smatch match;
    const std::regex places("roll 'tape': turn (\\S+) \\(row (\\d+)\\) and turn (\\S+) \\(row (\\d+)\\)");
    ASSERT_TRUE(std::regex_search(message, match, places)) << message;
    EXPECT_NEAR(std::fabs(std::stod(match[1]) - std::stod(match[3])), 1, 0.03) << message;  // half a cell is 0.012 turns
    EXPECT_NEAR(std::abs(std::stoi(match[2]) - std::stoi(match[4])), 42, 1.1) << message;   // 134 mm around, 3.17 mm a row
    EXPECT_NE(message.find(words), std::string::npos) << message;
    EXPECT_NE(message.find("raise roll.pitch"), std::string::npos) << message;
  }
}
