#include "tape/effects/membrane.inl"

#include <gtest/gtest.h>

#include "tests/support/derivatives.hpp"
#include "tests/support/effect_world.hpp"
using namespace tape;

namespace {
/// A square cell of a film without Poisson's effect, stretched along x by `stretch`.
struct Cell {
  static constexpr Real kWidth = 0.019;
  Scene scene;
  Assembly assembly;
  std::vector<Membrane::Element> elements;
  std::vector<Vec3> x;
  Membrane membrane;
  explicit Cell(Real stretch, Real nu = 0) {
    scene.films.push_back({});
    scene.films[0].poisson = nu;
    assembly.rest = {{0, 0}, {kWidth, 0}, {kWidth, kWidth}, {0, kWidth}};
    assembly.triangles = {{0, 1, 2}, {0, 2, 3}};
    assembly.strips = {{.film = 0, .first_vertex = 0, .first_triangle = 0, .vertices = 4, .triangles = 2, .columns = 2}};
    membrane = Membrane::build(scene, assembly, {}, elements);
    membrane.elements = {elements.data(), 2};
    const Mat3 R = rotation_exp(Vec3(0.5, -0.2, 0.9));
    for (const Vec2& X : assembly.rest) x.push_back(R * Vec3(stretch * X.x(), X.y(), 0));
  }
  StateView view() const {
    StateView s{};
    s.x = {x.data(), 4};
    return s;
  }
  Real energy() const { return membrane.energy(view(), 0) + membrane.energy(view(), 1); }
  /// [N] that pulls at the two vertices of the far end.
  Real pull() const {
    Vec3 sum = Vec3::Zero();
    for (int t = 0; t < 2; ++t)
      for (int k = 0; k < 3; ++k)
        if (const int v = elements[static_cast<std::size_t>(t)].v[k]; v == 1 || v == 2)
          sum += membrane.gradient(view(), t).segment<3>(3 * k);
    return sum.norm();
  }
};
}  // namespace

// The vinyl film: E A = 5e7 Pa x 0.18 mm x 19 mm = 171 N.
TEST(Membrane, AStripPullsWithTheForceOfStVenantKirchhoff) {  // F = E A lam (lam^2 - 1)/2
  EXPECT_NEAR(Cell(1.05).pull(), 9.2019375, 1e-9);
  EXPECT_NEAR(Cell(1.10).pull(), 19.7505, 1e-9);
}
TEST(Membrane, TheEnergyOfAStretchIsThatOfItsGreenStrain) {  // E A L/2 G^2 with G = (lam^2 - 1)/2; with nu: over 1 - nu^2, width held
  const Real G = (1.1 * 1.1 - 1) / 2;
  EXPECT_NEAR(Cell(1.1).energy(), 171.0 * 0.019 / 2 * G * G, 1e-12);
  EXPECT_NEAR(Cell(1.1, 0.45).energy(), 171.0 * 0.019 / 2 * G * G / (1 - 0.45 * 0.45), 1e-12);
}
TEST(Membrane, AtRestNothingPullsHoweverItIsTurned) {
  EXPECT_LT(Cell(1).pull(), 1e-11);
  EXPECT_LT(Cell(1).energy(), 1e-25);
}
TEST(Membrane, StretchedTheExactHessianNeedsNoProjectionCompressedItDoes) {
  const Cell tight(1.02), slack(0.98);
  const auto h = [](const Cell& c, HessianMode mode) { return c.membrane.hessian(c.view(), 0, mode); };
  EXPECT_LT((h(tight, HessianMode::exact) - h(tight, HessianMode::projected)).norm(), 1e-12 * h(tight, HessianMode::exact).norm());
  EXPECT_LT(test::smallest_eigenvalue(h(slack, HessianMode::exact)), -1);  // buckles: -S A h/l^2, some 1e2 N/m
  EXPECT_GE(test::smallest_eigenvalue(h(slack, HessianMode::projected) - h(slack, HessianMode::exact)), -1e-9);
}
