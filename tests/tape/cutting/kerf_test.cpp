#include "tape/cutting/kerf.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <string>

#include "tests/tape/cutting/cut_checks.hpp"

using namespace tape;
using testing::HasSubstr;

namespace {
constexpr Real kWidth = 0.019, kLength = 0.06, kCell = kWidth / 6;  // [m]
constexpr Real kKerf = 1.5e-3;                                      // [m]

StripMesh strip(MeshPattern pattern = MeshPattern::same, int cells_across = 6) {
  return make_strip_mesh({.length = kLength, .cells_across = cells_across, .pattern = pattern}, kWidth, 3);
}
Line across(Real x) { return {{x, -0.02}, {x, 0.02}}; }
/// Teeth along y, from the first given point on.
Line zigzag(Real x, Real pitch, Real height) {
  Line line;
  for (int k = 0; (k - 1) * pitch / 2 < 0.024; ++k) line.push_back({x + (k % 2) * height, -0.012 + k * pitch / 2});
  return line;
}
constexpr Real kClearance = 0.2e-3;  // [m]
Cut cut(const StripMesh& mesh, const Line& line, Real width = kKerf) { return cut_kerf(mesh, line, {width, kClearance}, {}); }

const MeshPattern kPatterns[] = {MeshPattern::same, MeshPattern::alternating, MeshPattern::crossed, MeshPattern::irregular};
}  // namespace

TEST(Kerf, AStraightCutTakesWidthTimesLengthAndLeavesTwoPieces) {
  for (MeshPattern pattern : kPatterns)
    for (Real width : {0.3e-3, 1.5e-3}) {
      const StripMesh mesh = strip(pattern);
      const Cut c = cut(mesh, across(0.0307), width);
      test::expect_sound(mesh, c, across(0.0307), width);
      EXPECT_EQ(c.pieces, 2);
      EXPECT_NEAR(c.kerf_area, width * kWidth, 1e-12 * kWidth * kLength);
      EXPECT_EQ(c.deviation, 0);
    }
}
TEST(Kerf, ASlantedCutTakesWidthOverCosine) {
  for (Real slope : {-1.0, 0.3, 1.5}) {
    const StripMesh mesh = strip();
    const Line line{{0.03 - 0.011 * slope, -0.011}, {0.03 + 0.011 * slope, 0.011}};
    const Cut c = cut(mesh, line);
    test::expect_sound(mesh, c, line, kKerf);
    EXPECT_NEAR(c.kerf_area, kKerf * kWidth * std::sqrt(1 + slope * slope), 1e-12 * kWidth * kLength);
  }
}
TEST(Kerf, ASlitEndsWithAFlatEndWithinTheStrip) {
  for (Real width : {0.3e-3, 1.5e-3}) {
    const StripMesh mesh = strip();
    const Line line{{0.031, -0.02}, {0.031, 0.001}};
    const Cut c = cut(mesh, line, width);
    test::expect_sound(mesh, c, line, width);
    EXPECT_EQ(c.pieces, 1);
    EXPECT_NEAR(c.kerf_area, width * (kWidth / 2 + 0.001), 1e-12 * kWidth * kLength);
    for (std::size_t v = 0; v < c.mesh.rest.size(); ++v) EXPECT_GE(distance_to_line(c.mesh.rest[v], line), width / 2 - 1e-9);
  }
}
TEST(Kerf, AHoleWithinTheStripIsCutToo) {
  const StripMesh mesh = strip();
  const Line line{{0.02, 0.001}, {0.04, -0.002}};
  const Cut c = cut(mesh, line);
  test::expect_sound(mesh, c, line, kKerf);
  EXPECT_EQ(c.pieces, 1);
  EXPECT_NEAR(c.kerf_area, kKerf * std::hypot(0.02, 0.003), 1e-12 * kWidth * kLength);
}
TEST(Kerf, TeethLargerThanTheKerfStayAndAreMitred) {
  // Both sides are the line moved along x by w / (2 cos a), a = angle of the teeth's sides with y: the area is that of a straight band.
  for (MeshPattern pattern : kPatterns) {
    const StripMesh mesh = strip(pattern);
    const Line line = zigzag(0.03, 6e-3, 3e-3);
    const Cut c = cut(mesh, line);
    test::expect_sound(mesh, c, line, kKerf);
    EXPECT_EQ(c.pieces, 2);
    EXPECT_EQ(c.deviation, 0);
    EXPECT_NEAR(c.kerf_area, kWidth * kKerf * std::sqrt(2.0), 1e-12 * kWidth * kLength);
  }
}
TEST(Kerf, OfTeethFinerThanTheKerfTheTipsCount) {
  // What is within w/2 of the teeth lies within w/2 of the band between their tips, but for what squaring adds there.
  const StripMesh mesh = strip();
  const Line line = zigzag(0.03, 1e-3, 1e-3);
  const Cut c = cut(mesh, line);
  test::expect_sound(mesh, c, line, kKerf);
  EXPECT_EQ(c.pieces, 2);
  EXPECT_EQ(c.deviation, 0);
  EXPECT_NEAR(c.kerf_area, kWidth * (kKerf + 1e-3), 0.01 * kWidth * kKerf);
}
TEST(Kerf, TeethThatTheMeshCannotHaveAreCutAlongTheirMean) {
  const StripMesh mesh = strip();
  const Line line = zigzag(0.03, 0.5e-3, 1e-3);
  const Cut c = cut(mesh, line, 0.3e-3);
  test::expect_sound(mesh, c, line, 0.3e-3);
  EXPECT_EQ(c.pieces, 2);
  EXPECT_GT(c.deviation, 0.25e-3);
  EXPECT_LE(c.deviation, 1e-3);
  EXPECT_LT(c.kerf_area, kWidth * (0.3e-3 + 0.5e-3));
}
TEST(Kerf, ALineIsNotMovedByMoreThanHalfACell) {
  // Teeth of 9 mm too steep to be cut, whose mean is 4.5 mm away.
  EXPECT_FALSE(cut(strip(), zigzag(0.03, 1.5e-3, 9e-3), 0.3e-3));
}
TEST(Kerf, ABladeAsWideAsTheStripSeparatesIt) {
  for (Real slope : {0.0, 0.6})
    for (Real short_by : {0.0, 1e-12, 1e-9, 1e-4, -1e-9}) {
      const StripMesh mesh = strip();
      const Real half = kWidth / 2 - short_by;
      const Line line{{0.03 - slope * half, -half}, {0.03 + slope * half, half}};
      const Cut c = cut(mesh, line);
      test::expect_sound(mesh, c, line, kKerf);
      EXPECT_EQ(c.pieces, 2) << "slope " << slope << ", short by " << short_by;
      EXPECT_NEAR(c.kerf_area, kWidth * kKerf * std::hypot(1, slope), 1e-12 * kWidth * kLength);
    }
}
TEST(Kerf, LinesThroughVerticesAndAlongEdgesAreOrdinary) {
  for (MeshPattern pattern : kPatterns)
    for (Real width : {0.3e-3, 1.5e-3, 2 * kCell})
      for (Real beside : {0.0, 1e-15, 1e-9, -1e-9, width / 2, -width / 2, width / 2 + 1e-9}) {
        const StripMesh mesh = strip(pattern);
        const Real x = 9 * kCell + beside;  // a row of vertices, or a side of the kerf along one
        const Line line = across(x), diagonal{{x - kWidth, -kWidth}, {x + kWidth, kWidth}}, along{{0.02, beside}, {0.041, beside}};
        for (const Line& l : {line, diagonal, along}) test::expect_sound(mesh, cut(mesh, l, width), l, width);
      }
}
TEST(Kerf, ALineThroughACornerIsCutOrRefused) {
  int cuts = 0;
  for (MeshPattern pattern : kPatterns)
    for (Real angle : {0.0, 20.0, 45.0, 70.0, 90.0, 110.0, 160.0})
      for (Real beside : {0.0, 1e-9, -1e-9, kKerf / 2, -kKerf / 2, 0.02 * kCell, kCell}) {
        const StripMesh mesh = strip(pattern);
        const Vec2 d(std::cos(angle * std::numbers::pi / 180), std::sin(angle * std::numbers::pi / 180)), corner(beside, -kWidth / 2);
        const Line line{corner - 0.1 * d, corner + 0.1 * d};
        const Cut c = cut(mesh, line);
        if (c) test::expect_sound(mesh, c, line, kKerf);
        cuts += static_cast<bool>(c);
        EXPECT_EQ(c.mesh.rest.empty(), !c.refusal.empty()) << c.refusal;
      }
  EXPECT_GT(cuts, 60);  // of 196; those that trim the end, say
}
TEST(Kerf, ASecondCutAtTheSamePlaceCutsNothing) {
  for (const Line& line : {across(0.03), zigzag(0.03, 6e-3, 3e-3), Line{{0.031, -0.02}, {0.034, 0.001}}})
    for (Real shift : {0.0, 1e-12, 1e-9}) {
      const Cut first = cut(strip(), line);
      ASSERT_TRUE(first) << first.refusal;
      Line again = line;
      for (Vec2& p : again) p.x() += shift;
      EXPECT_EQ(cut(first.mesh, again).refusal, "the line cuts nothing");
    }
}
TEST(Kerf, ASecondCutThatOverlapsTheFirstTakesOnlyWhatIsLeft) {
  const StripMesh mesh = strip();
  const Cut first = cut(mesh, across(0.03));
  ASSERT_TRUE(first);
  const Cut second = cut(first.mesh, across(0.03 + kKerf / 2));
  test::expect_sound(first.mesh, second, across(0.03 + kKerf / 2), kKerf);
  EXPECT_NEAR(second.kerf_area, kWidth * kKerf / 2, 1e-12 * kWidth * kLength);
}
TEST(Kerf, ASlitIsCutOnAlongItsLineEvenWithASideStep) {
  const StripMesh mesh = strip();
  for (Real step : {0.0, 1e-12, 1e-9, 1e-5, 1e-4, -2e-4}) {
    const Cut slit = cut(mesh, {{0.031, -0.02}, {0.031, 0.001}});
    ASSERT_TRUE(slit) << slit.refusal;
    const Line rest{{0.031 + step, -0.001}, {0.031 + step, 0.02}};
    const Cut through = cut(slit.mesh, rest);
    test::expect_sound(slit.mesh, through, rest, kKerf);
    EXPECT_EQ(through.pieces, 2) << "step " << step;
  }
}
TEST(Kerf, ARemainderNarrowerThanTheShortestEdgeGoesWithTheKerf) {
  const StripMesh mesh = strip();
  const Cut first = cut(mesh, across(0.03));
  ASSERT_TRUE(first);
  const Real cell = cell_size(first.mesh);
  for (Real wide : {5e-4, 0.02}) {
    const Line line = across(0.03 + kKerf + wide * cell);
    const Cut second = cut(first.mesh, line);
    test::expect_sound(first.mesh, second, line, kKerf);
    EXPECT_EQ(second.pieces, 2);
    EXPECT_NEAR(second.kerf_area, kWidth * (kKerf + wide * cell), 1e-12 * kWidth * kLength);
  }
  const Cut narrow = cut(first.mesh, across(0.03 + kKerf + 0.2 * cell));
  test::expect_sound(first.mesh, narrow, across(0.03 + kKerf), kKerf);
  EXPECT_EQ(narrow.pieces, 3);
}
TEST(Kerf, ANarrowBridgeIsRefused) {
  const Real y = kWidth / 2 - kKerf / 2 - 0.02 * kCell;
  EXPECT_THAT(cut(strip(), {{0.02, y}, {0.04, y}}).refusal, HasSubstr("narrower"));
}
TEST(Kerf, AnOpeningNarrowerThanTheClearanceIsRefused) {
  // Of the flat end of a kerf at 45 degrees one corner ends 0.05 mm beyond the edge: it opens 0.1 mm there.
  const Real width = 3e-3, y = kWidth / 2 + 0.05e-3 - width / 2 / std::sqrt(2);
  const Line line{{0.023, y - 0.007}, {0.03, y}};
  EXPECT_THAT(cut(strip(), line, width).refusal, HasSubstr("a gap narrower than 0.2 mm"));
  Line higher = line;
  for (Vec2& p : higher) p.y() += 0.2e-3;
  EXPECT_EQ(cut(strip(), higher, width).refusal, "");
}
TEST(Kerf, TrianglesACellAwayStayWithTheirDiagonals) {
  // Vertices 0.69 and 0.31 cells from the line are too near to the kerf. The next ones, at 1.69 and 1.31 cells, stay.
  for (MeshPattern pattern : {MeshPattern::same, MeshPattern::alternating}) {
    const StripMesh mesh = strip(pattern);
    test::expect_the_rest_unchanged(mesh, cut(mesh, across(9.69 * kCell)), across(9.69 * kCell), 1.6 * kCell);
  }
}
TEST(Kerf, TheEndOfAStripCanBeTrimmed) {
  const StripMesh mesh = strip();
  const Cut c = cut(mesh, across(0.1e-3));
  test::expect_sound(mesh, c, across(0.1e-3), kKerf);
  EXPECT_EQ(c.pieces, 1);
  EXPECT_NEAR(c.kerf_area, kWidth * (kKerf / 2 + 0.1e-3), 1e-12 * kWidth * kLength);
}
TEST(Kerf, TooSharpAnAngleWithTheEdgeIsRefused) {
  const Real run = 0.019 / std::tan(8 * std::numbers::pi / 180);
  const StripMesh mesh = make_strip_mesh({.length = 0.3, .cells_across = 6}, kWidth, 1);
  EXPECT_THAT(cut(mesh, {{0.15 - run, -0.019}, {0.15 + run, 0.019}}).refusal, HasSubstr("deg would be left"));
}
TEST(Kerf, ALineBesideTheStripCutsNothing) {
  EXPECT_EQ(cut(strip(), {{0.02, 0.02}, {0.04, 0.02}}).refusal, "the line cuts nothing");
  EXPECT_EQ(cut(strip(), across(kLength + kKerf / 2)).refusal, "the line cuts nothing");
  EXPECT_EQ(cut(strip(), across(7)).refusal, "the line cuts nothing");
  EXPECT_EQ(cut(strip(), {{0.02, 0}}).refusal, "the line is a point");
}
TEST(Kerf, AStripThatTheKerfSwallowsIsRefused) {
  EXPECT_EQ(cut(make_strip_mesh({.length = 1e-3, .cells_across = 6}, kWidth, 1), across(0.5e-3)).refusal, "nothing would be left");
}
TEST(Kerf, OnlyTheGivenPieceIsCut) {
  const StripMesh mesh = strip();
  const Cut halves = cut(mesh, across(0.03));
  ASSERT_TRUE(halves);
  const Line along{{0.015, 0.001}, {0.045, 0.001}};
  const int left = 0;  // triangles keep their order: the first one is at the start of the strip
  const Cut c = cut_kerf(halves.mesh, along, {kKerf, kClearance}, {}, left);
  ASSERT_EQ(c.refusal, "");
  test::expect_a_strip_mesh(c);
  test::expect_quality(halves.mesh, c, kKerf, 15);
  test::expect_the_rest_unchanged(halves.mesh, c, {{0.015, 0.001}, {0.03, 0.001}}, 4 * kKerf + 3 * kCell);
  test::expect_true_parents(halves.mesh, c);
  EXPECT_NEAR(c.kerf_area, kKerf * (0.015 - kKerf / 2), 1e-12 * kWidth * kLength);
}
TEST(Kerf, AStripBecomesManyPieces) {
  Cut c;
  c.mesh = strip(MeshPattern::irregular);
  Real kerf = 0;
  const Real before = test::area(c.mesh);
  for (int k = 0; k < 9; ++k) {
    const Line line{{0.0061 * (k + 1), -0.02}, {0.0061 * (k + 1) - 0.002, 0.02}};
    const StripMesh old = c.mesh;
    c = cut(old, line, 0.5e-3);
    test::expect_sound(old, c, line, 0.5e-3);
    kerf += c.kerf_area;
    EXPECT_EQ(c.pieces, k + 2);
  }
  const StripMesh old = c.mesh;
  const Line along{{-0.01, 0.001}, {0.07, 0.001}};
  c = cut(old, along, 0.5e-3);
  test::expect_sound(old, c, along, 0.5e-3);
  EXPECT_EQ(c.pieces, 20);
  EXPECT_NEAR(test::area(c.mesh) + kerf + c.kerf_area, before, 1e-12 * before);
}
TEST(Kerf, ACutIsTheSameEachTime) {
  const Cut a = cut(strip(), zigzag(0.03, 6e-3, 3e-3)), b = cut(strip(), zigzag(0.03, 6e-3, 3e-3));
  EXPECT_EQ(a.mesh.rest, b.mesh.rest);
  EXPECT_EQ(a.mesh.triangles, b.mesh.triangles);
}
TEST(Kerf, InputThatIsNoLineIsAnError) {
  EXPECT_THROW(cut(strip(), {{0.02, 0}, {std::nan(""), 0}}), InputError);
  EXPECT_THROW(cut(strip(), across(0.03), 0), InputError);
  EXPECT_THROW(cut(strip(), across(0.03), kClearance), SettingsError);
  EXPECT_THROW(cut(strip(), across(0.03), std::numeric_limits<Real>::infinity()), InputError);
  EXPECT_THROW(cut_kerf(strip(), across(0.03), {}, {.min_angle = 40}), SettingsError);
}

TEST(Kerf, RandomCutsOfManyMeshesAreSoundOrRefused) {
  std::mt19937_64 generator(20240607);
  const auto random = [&](Real low, Real high) { return low + (high - low) * static_cast<Real>(generator() >> 11) * 0x1p-53; };
  std::vector<StripParams> meshes;
  for (MeshPattern pattern : kPatterns)
    for (int cells : {6, 15}) meshes.push_back({.length = kLength, .cells_across = cells, .pattern = pattern});
  for (Real angle : {30.0, 45.0, -17.0}) meshes.push_back({.length = kLength, .cells_across = 6, .grid_angle = angle});
  int cuts = 0, tries = 0;
  for (const StripParams& params : meshes)
    for (int run = 0; run < 8; ++run) {
      StripMesh mesh = make_strip_mesh(params, kWidth, run);
      const Real width = random(0.3e-3, 1.5e-3);
      for (int turn = 0; turn < 4; ++turn) {
        Line line{{random(-0.005, 0.065), random(-0.012, 0.012)}};
        const int corners = 1 + static_cast<int>(random(0, 4));
        for (int k = 0; k < corners; ++k) line.push_back(line.back() + Vec2(random(-0.01, 0.01), random(-0.02, 0.02)));
        const Cut c = cut(mesh, line, width);
        ++tries;
        EXPECT_EQ(c.mesh.rest.empty(), !c.refusal.empty());
        if (!c) continue;
        ++cuts;
        test::expect_sound(mesh, c, line, width);
        if (HasFailure()) FAIL() << "run " << run << ", cut " << turn << " of " << to_text(params.pattern) << " " << params.grid_angle;
        mesh = c.mesh;
      }
    }
  EXPECT_GT(cuts, tries / 2);
}
TEST(Kerf, StretchedCellsGetNoWorseThanTheyAre) {
  for (Real length : {0.5e-3, 1e-3, 8e-3}) {
    const StripMesh mesh = make_strip_mesh({.length = kLength, .cells_across = 6, .cell_length = length}, kWidth, 1);
    const Real angle = std::atan(std::min(length / kCell, kCell / length)) * 180 / std::numbers::pi;
    for (const Line& line : {across(0.0307), Line{{0.02, -0.011}, {0.035, 0.011}}, Line{{0.031, -0.02}, {0.032, 0.001}}})
      test::expect_sound(mesh, cut(mesh, line), line, kKerf, angle >= 15 ? 15 : 0.75 * angle);
  }
}
