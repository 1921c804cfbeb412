#include "tape/cutting/transfer.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "tests/tape/cutting/cut_checks.hpp"

using namespace tape;

namespace {
constexpr Real kWidth = 0.019, kLength = 0.06, kKerf = 1.5e-3;  // [m]
constexpr Real kPerArea = 0.18e-3 * 1100;                       // [kg/m^2]

/// A strip that is bent and moves unevenly.
struct Moving {
  StripMesh mesh;
  std::vector<Vec3> x, v;
};
Moving moving(MeshPattern pattern = MeshPattern::irregular) {
  Moving m{make_strip_mesh({.length = kLength, .cells_across = 6, .pattern = pattern}, kWidth, 5), {}, {}};
  std::mt19937_64 generator(11);
  const auto random = [&] { return 2 * static_cast<Real>(generator() >> 11) * 0x1p-53 - 1; };
  for (const Vec2& p : m.mesh.rest) {
    m.x.push_back({0.3 + 0.02 * std::sin(50 * p.x()), p.y(), 0.02 * std::cos(50 * p.x()) + 0.001 * random()});
    m.v.push_back({0.1 + 0.01 * random(), 3 * p.x(), -0.2 + 0.02 * random()});
  }
  return m;
}
const Line kLine{{0.031, -0.02}, {0.034, 0.02}};

void expect_near(const Vec3& a, const Vec3& b, Real tolerance) {
  EXPECT_LE((a - b).norm(), tolerance) << a.transpose() << " against " << b.transpose();
}
}  // namespace

TEST(Transfer, AFieldThatIsLinearOverTheStripIsCarriedOverExactly) {
  const Moving m = moving();
  const Cut cut = cut_kerf(m.mesh, kLine, {}, {});
  ASSERT_TRUE(cut) << cut.refusal;
  std::vector<Real> field;
  const auto value = [](const Vec2& p) { return 2 + 30 * p.x() - 70 * p.y(); };
  for (const Vec2& p : m.mesh.rest) field.push_back(value(p));
  const std::vector<Real> now = interpolated(m.mesh, cut, field);
  for (std::size_t i = 0; i < now.size(); ++i) EXPECT_NEAR(now[i], value(cut.mesh.rest[i]), 1e-13);
}
TEST(Transfer, VerticesThatSurviveKeepTheirValuesToTheBit) {
  const Moving m = moving();
  const Cut cut = cut_kerf(m.mesh, kLine, {}, {});
  ASSERT_TRUE(cut);
  const std::vector<Vec3> x = interpolated(m.mesh, cut, m.x);
  for (std::size_t i = 0; i < m.x.size(); ++i) {
    if (cut.new_vertex[i] < 0) continue;
    EXPECT_EQ(x[cut.new_vertex[i]], m.x[i]);
  }
}
TEST(Transfer, MassAndMomentumOfPiecesAndKerfAreWhatTheStripHad) {
  for (MeshPattern pattern : {MeshPattern::same, MeshPattern::alternating, MeshPattern::crossed, MeshPattern::irregular})
    for (const Line& line : {kLine, Line{{0.02, -0.001}, {0.04, 0.003}}, Line{{0.03, -0.02}, {0.035, 0}, {0.03, 0.02}}}) {
      const Moving m = moving(pattern);
      const Cut cut = cut_kerf(m.mesh, line, {}, {});
      ASSERT_TRUE(cut) << cut.refusal;
      const MovedOn now = move_on(m.mesh, cut, m.x, m.v, kPerArea);
      const Momentum before = momentum(lumped_mass(m.mesh, kPerArea), m.x, m.v), after = momentum(now.mass, now.x, now.v);
      EXPECT_NEAR(before.mass, kPerArea * kWidth * kLength, 1e-12 * before.mass);
      EXPECT_NEAR(after.mass + kPerArea * cut.kerf_area, before.mass, 1e-12 * before.mass);
      EXPECT_NEAR(now.kerf.mass, kPerArea * cut.kerf_area, 1e-12 * before.mass);
      expect_near(after.linear + now.kerf.linear, before.linear, 1e-12 * before.linear.norm());
      expect_near(after.angular + now.kerf.angular, before.angular, 1e-12 * before.angular.norm());
      EXPECT_GT(now.largest_change, 0);
      EXPECT_LT(now.largest_change, 0.02);
    }
}
TEST(Transfer, TheKerfTakesTheIntegralsOverItself) {
  // v = (0, a + b X, 0) at x = (X, Y, 0), over a straight kerf of width w at X0 across the width B, mass m: linear momentum m (a + b X0),
  // angular momentum m [X0 (a + b X0) + b w^2/12].
  const StripMesh mesh = make_strip_mesh({.length = kLength, .cells_across = 6}, kWidth, 1);
  std::vector<Vec3> x, v;
  for (const Vec2& p : mesh.rest) {
    x.push_back({p.x(), p.y(), 0});
    v.push_back({0, 0.5 + 20 * p.x(), 0});
  }
  const Real at = 0.0307;
  const Cut cut = cut_kerf(mesh, {{at, -0.02}, {at, 0.02}}, {}, {});
  ASSERT_TRUE(cut);
  const MovedOn now = move_on(mesh, cut, x, v, kPerArea);
  const Real mass = kPerArea * kKerf * kWidth, linear = mass * (0.5 + 20 * at),
             angular = mass * (at * (0.5 + 20 * at) + 20 * kKerf * kKerf / 12);
  EXPECT_NEAR(now.kerf.mass, mass, 1e-12 * mass);
  expect_near(now.kerf.linear, {0, linear, 0}, 1e-12 * linear);
  expect_near(now.kerf.angular, {0, 0, angular}, 1e-12 * angular);
}
TEST(Transfer, PiecesOfAStripThatTravelsTravelOn) {
  Moving m = moving();
  for (Vec3& v : m.v) v = {0.3, -0.2, 0.5};
  const Cut cut = cut_kerf(m.mesh, kLine, {}, {});
  ASSERT_TRUE(cut);
  std::vector<Vec3> linear(static_cast<std::size_t>(cut.pieces), Vec3::Zero());
  std::vector<Real> mass(linear.size(), 0);
  const MovedOn now = move_on(m.mesh, cut, m.x, m.v, kPerArea);
  for (std::size_t i = 0; i < now.v.size(); ++i) mass[cut.piece[i]] += now.mass[i], linear[cut.piece[i]] += now.mass[i] * now.v[i];
  for (std::size_t p = 0; p < mass.size(); ++p) expect_near(linear[p] / mass[p], {0.3, -0.2, 0.5}, 1e-13);
}
TEST(Transfer, EvenASmallPieceOfATurningStripTurnsOnAsItDid) {
  // A remainder 0.3 cells long between two cuts of a flat strip that turns at 10 rad/s. What lumping gives the patch in moment of inertia
  // is less than m h^2/2 for its mass m and cells h, here 2 % of the strip's.
  const StripMesh mesh = make_strip_mesh({.length = kLength, .cells_across = 6}, kWidth, 1);
  const Vec3 spin(1, -2, 9.5);
  const Cut first = cut_kerf(mesh, {{0.03, -0.02}, {0.03, 0.02}}, {}, {});
  ASSERT_TRUE(first);
  std::vector<Vec3> x, v;
  for (const Vec2& p : first.mesh.rest) {
    x.push_back({p.x(), p.y(), 0.1});
    v.push_back(spin.cross(x.back()));
  }
  const Cut second = cut_kerf(first.mesh, {{0.0325, -0.02}, {0.0325, 0.02}}, {}, {});
  ASSERT_TRUE(second) << second.refusal;
  ASSERT_EQ(second.pieces, 3);
  const MovedOn now = move_on(first.mesh, second, x, v, kPerArea);
  for (std::size_t i = 0; i < now.v.size(); ++i) expect_near(now.v[i], spin.cross(now.x[i]), 0.02 * spin.norm() * 0.02);
}
TEST(Transfer, TheCorrectionIsARigidMotionOfEachPiece) {
  const Moving m = moving();
  const Cut cut = cut_kerf(m.mesh, kLine, {}, {});
  ASSERT_TRUE(cut);
  const MovedOn now = move_on(m.mesh, cut, m.x, m.v, kPerArea);
  const std::vector<Vec3> plain = interpolated(m.mesh, cut, m.v);
  Real largest = 0;
  for (std::size_t i = 0; i < plain.size(); ++i) {
    largest = std::max(largest, (now.v[i] - plain[i]).norm());
    for (std::size_t j = 0; j < i; j += 7) {
      if (cut.piece[i] != cut.piece[j]) continue;
      EXPECT_NEAR(  // distances do not change
          (now.x[i] - now.x[j]).dot(now.v[i] - plain[i] - now.v[j] + plain[j]), 0, 1e-15);
    }
  }
  EXPECT_NEAR(now.largest_change, largest, 1e-15);
}
TEST(Transfer, WhereTheOriginIsDoesNotMatter) {
  const Moving m = moving();
  const Cut cut = cut_kerf(m.mesh, kLine, {}, {});
  ASSERT_TRUE(cut);
  std::vector<Vec3> far = m.x;
  for (Vec3& p : far) p += Vec3(3, -2, 1);
  const MovedOn here = move_on(m.mesh, cut, m.x, m.v, kPerArea), there = move_on(m.mesh, cut, far, m.v, kPerArea);
  for (std::size_t i = 0; i < here.v.size(); ++i) expect_near(here.v[i], there.v[i], 1e-9);
}
TEST(Transfer, APieceThatIsNotCutKeepsItsVelocitiesToTheBit) {
  const Moving m = moving();
  const Cut first = cut_kerf(m.mesh, kLine, {}, {});
  ASSERT_TRUE(first);
  const MovedOn halves = move_on(m.mesh, first, m.x, m.v, kPerArea);
  const Cut second = cut_kerf(first.mesh, {{0.05, -0.02}, {0.05, 0.02}}, {}, {});
  ASSERT_TRUE(second);
  const MovedOn now = move_on(first.mesh, second, halves.x, halves.v, kPerArea);
  for (std::size_t i = 0; i < halves.v.size(); ++i) {
    if (first.piece[i] != first.piece[0]) continue;
    EXPECT_EQ(now.v[second.new_vertex[i]], halves.v[i]);
  }
}
TEST(Transfer, APointIsFoundAgainInTheNewMeshOrWentWithTheKerf) {
  const Moving m = moving();
  const Line line{{0.031, -0.02}, {0.031, 0.02}};
  const Cut cut = cut_kerf(m.mesh, line, {}, {});
  ASSERT_TRUE(cut);
  int gone = 0;
  for (int t = 0; t < static_cast<int>(m.mesh.triangles.size()); ++t)
    for (const Vec3& weight : {Vec3(0.2, 0.3, 0.5), Vec3(0.8, 0.1, 0.1), Vec3(0, 1, 0)}) {
      const Index3& old = m.mesh.triangles[t];
      const Vec2 p = weight[0] * m.mesh.rest[old[0]] + weight[1] * m.mesh.rest[old[1]] + weight[2] * m.mesh.rest[old[2]];
      const Place found = new_place(m.mesh, cut, {t, weight});
      ASSERT_EQ(found.triangle < 0, std::fabs(p.x() - 0.031) < kKerf / 2) << p.transpose();
      gone += found.triangle < 0;
      if (found.triangle < 0) continue;
      const Index3& now = cut.mesh.triangles[found.triangle];
      const Vec2 q =
          found.weight[0] * cut.mesh.rest[now[0]] + found.weight[1] * cut.mesh.rest[now[1]] + found.weight[2] * cut.mesh.rest[now[2]];
      EXPECT_LT((p - q).norm(), 1e-15);
      EXPECT_GE(found.weight.minCoeff(), -1e-9);
    }
  EXPECT_GT(gone, 0);
}
