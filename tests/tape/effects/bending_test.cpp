#include "tape/effects/bending.inl"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <numbers>

#include "tape/model/strip_mesh.hpp"
#include "tests/support/derivatives.hpp"
using namespace tape;

namespace {
/// A strip of vinyl six cells wide, as bending sees it.
class Strip60 {
 public:
  static constexpr Real kLength = 0.06, kCell = 0.019 / 6;
  Strip60(MeshPattern pattern, Real grid_angle, BendingLaw law, Real nu = 0) {
    StripParams params;
    params.length = kLength;
    params.pattern = pattern;
    params.grid_angle = grid_angle;
    mesh_ = make_strip_mesh(params, 0.019, 1);
    Scene scene;
    scene.films.push_back({});
    scene.films[0].poisson = nu;
    D = scene.films[0].plate_stiffness();
    Assembly assembly;
    assembly.rest = mesh_.rest;
    assembly.triangles = mesh_.triangles;
    assembly.strips = {{.film = 0,
                        .first_vertex = 0,
                        .first_triangle = 0,
                        .vertices = static_cast<int>(mesh_.rest.size()),
                        .triangles = static_cast<int>(mesh_.triangles.size()),
                        .columns = mesh_.columns}};
    bending_ = Bending::build(scene, assembly, {law}, elements_);
    bending_.elements = {elements_.data(), static_cast<int>(elements_.size())};
  }
  Strip60(const Strip60&) = delete;
  Strip60& operator=(const Strip60&) = delete;

  /// Energy per area over that of a plate, D kappa^2/2, where the strip lies on a cylinder; without the two ends.
  Real on_cylinder(Real kappa) const {
    std::vector<Vec3> x;
    for (const Vec2& X : mesh_.rest) x.emplace_back(std::sin(kappa * X.x()) / kappa, X.y(), (1 - std::cos(kappa * X.x())) / kappa);
    Real energy = 0, area = 0;
    for (std::size_t t = 0; t < mesh_.triangles.size(); ++t) {
      const Index3& v = mesh_.triangles[t];
      const Real middle = (X(v[0]).x() + X(v[1]).x() + X(v[2]).x()) / 3;
      if (middle < 2 * kCell || middle > kLength - 2 * kCell) continue;
      const Vec2 a = X(v[1]) - X(v[0]), b = X(v[2]) - X(v[0]);
      area += (a.x() * b.y() - a.y() * b.x()) / 2;
      energy += bending_.energy(view(x), static_cast<int>(t));
    }
    return energy / (area * D * kappa * kappa / 2);
  }
  /// As `on_cylinder` for small kappa, where only the ends are held and the rest is in equilibrium: what a strip really feels.
  Real in_equilibrium() const {
    const Eigen::Index n = static_cast<Eigen::Index>(mesh_.rest.size());
    Eigen::VectorXd bent(n);
    std::vector<Eigen::Index> free;
    for (Eigen::Index i = 0; i < n; ++i) {
      const Real x = X(static_cast<int>(i)).x();
      bent[i] = x * x / 2;
      if (x > 1.6 * kCell && x < kLength - 1.6 * kCell) free.push_back(i);
    }
    const Eigen::MatrixXd H = across();
    const Eigen::VectorXd load = (H * bent)(free);
    const Real drop = load.dot(H(free, free).eval().ldlt().solve(load)) / 2;
    return on_cylinder(1e-3) - drop / ((kLength - 4 * kCell) * 0.019 * D / 2);
  }
  const std::vector<Bending::Element>& elements() const { return elements_; }
  Real D;  ///< [N m]

 private:
  const Vec2& X(int v) const { return mesh_.rest[static_cast<std::size_t>(v)]; }
  static StateView view(const std::vector<Vec3>& x) {
    StateView s{};
    s.x = {x.data(), static_cast<int>(x.size())};
    return s;
  }
  /// Stiffness [N/m] of the flat strip against moves of its vertices out of the plane.
  Eigen::MatrixXd across() const {
    std::vector<Vec3> x;
    for (const Vec2& p : mesh_.rest) x.emplace_back(p.x(), p.y(), 0);
    Eigen::MatrixXd H = Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(x.size()), static_cast<Eigen::Index>(x.size()));
    for (int i = 0; i < static_cast<int>(elements_.size()); ++i) {
      const MatN<18, 18> h = bending_.hessian(view(x), i, HessianMode::projected);
      const int(&v)[6] = elements_[static_cast<std::size_t>(i)].v;
      for (int a = 0; a < 6; ++a)
        for (int b = 0; b < 6; ++b) H(v[a], v[b]) += h(3 * a + 2, 3 * b + 2);
    }
    return H;
  }
  StripMesh mesh_;
  std::vector<Bending::Element> elements_;
  Bending bending_;
};

struct MeshCase {
  MeshPattern pattern;
  Real grid_angle;
};
const MeshCase kMeshes[] = {{MeshPattern::same, 0},  {MeshPattern::same, 30},       {MeshPattern::same, 45},   {MeshPattern::same, 60},
                            {MeshPattern::same, 90}, {MeshPattern::alternating, 0}, {MeshPattern::crossed, 0}, {MeshPattern::irregular, 0}};
std::string name(const MeshCase& m) { return to_text(m.pattern) + " at " + to_text(m.grid_angle); }

/// Two triangles of edge length l, folded about their common edge.
struct Fold {
  Scene scene;
  Assembly assembly;
  std::vector<Bending::Element> elements;
  Bending bending;
  explicit Fold(BendingLaw law) {
    scene.films.push_back({});
    assembly.rest = {{0, 0}, {3e-3, 0}, {1e-3, 2e-3}, {2e-3, -2e-3}};
    assembly.triangles = {{0, 1, 2}, {1, 0, 3}};
    assembly.strips = {{.film = 0, .first_vertex = 0, .first_triangle = 0, .vertices = 4, .triangles = 2, .columns = 2}};
    bending = Bending::build(scene, assembly, {law}, elements);
    bending.elements = {elements.data(), 2};
  }
  Fold(const Fold&) = delete;
  Fold& operator=(const Fold&) = delete;
  Real energy(Real angle) const {
    const std::vector<Vec3> x{{0, 0, 0}, {3e-3, 0, 0}, {1e-3, 2e-3, 0}, {2e-3, -2e-3 * std::cos(angle), 2e-3 * std::sin(angle)}};
    StateView s{};
    s.x = {x.data(), 4};
    return bending.energy(s, 0) + bending.energy(s, 1);
  }
};
}  // namespace

TEST(Bending, OnACylinderTheDefaultLawHasTheEnergyOfAPlateOnAllMeshes) {
  for (const MeshCase& m : kMeshes) {
    const Strip60 strip(m.pattern, m.grid_angle, BendingParams{}.law);
    RecordProperty(name(m), to_text(strip.on_cylinder(1e-3)));
    EXPECT_NEAR(strip.on_cylinder(1e-3), 1, 0.03) << name(m);
    EXPECT_NEAR(strip.on_cylinder(20), 1, 0.03) << name(m);  // radius 50 mm
  }
}
TEST(Bending, InEquilibriumTheDefaultLawIsAsStiffAsAPlateOnAllMeshes) {
  Real low = 2, high = 0;
  for (const MeshCase& m : kMeshes) {
    const Strip60 strip(m.pattern, m.grid_angle, BendingParams{}.law);
    const Real stiffness = strip.in_equilibrium();
    RecordProperty(name(m), to_text(stiffness));
    EXPECT_NEAR(stiffness, 1, 0.03) << name(m);
    if (m.pattern == MeshPattern::same) low = std::min(low, stiffness), high = std::max(high, stiffness);
  }
  EXPECT_LE(high - low, 0.03) << "spread over the angles of a same-diagonal mesh";
}
TEST(Bending, TheHingeLawIsExactOnlyAlongAStructuredStrip) {  // trap T1
  EXPECT_NEAR(Strip60(MeshPattern::same, 0, BendingLaw::hinge).on_cylinder(1e-3), 1, 1e-6);
  EXPECT_GT(Strip60(MeshPattern::same, -45, BendingLaw::hinge).on_cylinder(1e-3), 2);
  EXPECT_GT(Strip60(MeshPattern::crossed, 0, BendingLaw::hinge).on_cylinder(1e-3), 1.3);
  for (const MeshCase& m : kMeshes) {
    const Strip60 strip(m.pattern, m.grid_angle, BendingLaw::hinge);
    RecordProperty(name(m), to_text(strip.on_cylinder(1e-3)) + ", in equilibrium " + to_text(strip.in_equilibrium()));
  }
}
TEST(Bending, PoissonsRatioStiffensThePlateAsItShould) {  // D = E h^3 / (12 (1 - nu^2))
  const Strip60 strip(MeshPattern::same, 0, BendingLaw::shape_operator, 0.45);
  EXPECT_NEAR(strip.D, 5e7 * std::pow(1.8e-4, 3) / 12 / (1 - 0.45 * 0.45), 1e-18);
  EXPECT_NEAR(strip.on_cylinder(1e-3), 1, 1e-6);
}
TEST(Bending, EveryStiffnessIsPositive) {
  for (const MeshCase& m : kMeshes) {
    const Strip60 strip(m.pattern, m.grid_angle, BendingLaw::shape_operator);
    for (const Bending::Element& e : strip.elements()) {
      const Mat3 K = Eigen::Map<const Mat3>(&e.K[0][0]);
      EXPECT_EQ(K, K.transpose());
      EXPECT_GE(test::smallest_eigenvalue(K), -1e-14 * K.norm()) << name(m);
    }
  }
}
TEST(Bending, AHingeHasItsClosedForm) {  // E = k w theta^2, k = D/6, w = 3 |e|^2/(A1 + A2): |e| = 3 mm, both areas 3 mm^2
  const Fold fold(BendingLaw::hinge);
  const Real k = fold.scene.films[0].plate_stiffness() / 6, w = 3 * 9e-6 / 6e-6;
  for (Real angle : {0.1, -0.1, 1.0, 3.0}) EXPECT_NEAR(fold.energy(angle), k * w * angle * angle, 1e-12 * k);
}
TEST(Bending, AFoldCostsMoreTheSharperItIs) {
  for (BendingLaw law : {BendingLaw::hinge, BendingLaw::shape_operator}) {
    const Fold fold(law);
    Real last = -1;
    for (int k = 0; k <= 31; ++k) {
      const Real energy = fold.energy(0.1 * k), mirrored = fold.energy(-0.1 * k);
      EXPECT_GT(energy, last);
      EXPECT_NEAR(mirrored, energy, 1e-12 * energy);
      last = energy;
    }
  }
}
TEST(Bending, AFilmWithoutModulusNeedsAndBuildsNothing) {
  Scene scene;
  scene.films.push_back({});
  scene.strips.push_back({});
  EXPECT_EQ(Bending::needed(scene, {}), "film.bending_modulus");
  scene.films[0].bending_modulus = 0;
  EXPECT_EQ(Bending::needed(scene, {}), "");
  Fold fold(BendingLaw::hinge);
  fold.scene.films[0].bending_modulus = 0;
  std::vector<Bending::Element> elements;
  Bending::build(fold.scene, fold.assembly, {}, elements);
  EXPECT_TRUE(elements.empty());
}
