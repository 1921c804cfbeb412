#include "cosim/run/measure.hpp"

#include <gtest/gtest.h>

#include <numbers>

#include "cosim/run/attachment.hpp"
#include "tape/math/rotation.hpp"
#include "tape/model/primitives.hpp"
#include "tests/support/simulation.hpp"

namespace {
using cosim::Claim;
using cosim::Quantity;
using tape::Real;
using tape::Vec3;

constexpr int kRows = 5, kColumns = 3;
constexpr Real kCell = 0.01;  // [m] along the strip, which is as long as four of them

/// A strip of two by four cells along x over two boxes, left and right of y = 0, the left one turned by a right angle about z. Nothing
/// steps: what adheres is what the test says.
struct Sealed {
  tape::World world = tape::World::build([] {
    tape::Strip strip = tape::test::flat_strip((kRows - 1) * kCell, 2, Vec3(0, 0, 3e-4));
    strip.mesh.cell_length = kCell;
    strip.material = 1;
    tape::Setup setup = tape::test::strip_setup(strip);
    setup.scene.materials.push_back({.name = "tape"});
    const tape::TriangleMesh box = tape::box_mesh(Vec3(0.1, 0.1, 0.02), {1, 1, 1});
    for (const char* name : {"left", "right"}) {
      const Real side = std::string(name) == "left" ? -1 : 1;
      tape::Body& body = tape::test::add_body(setup, name, box, tape::Motion::fixed, Vec3(0.02, side * 0.0515, -0.01));
      if (side < 0) body.pose.rotation = tape::rotation_exp(Vec3(0, 0, std::numbers::pi / 2));
    }
    tape::AdhesivePair& sticks = setup.scene.adhesives.emplace_back();
    sticks.a = 1, sticks.adhesion.law = tape::AdhesionLaw::per_pair;
    return setup;
  }());
  tape::State state = tape::State::start(world);

  static int vertex(int row, int column) { return row * kColumns + column; }
  /// A triangle of a body.
  int triangle_of(int body) const { return world.assembly.bodies[static_cast<std::size_t>(body)].first_triangle; }
  void attach(int vertex, int triangle, Real beta) {
    std::get<tape::MemoryOf<tape::Cohesion>>(state.memory).pairs.push_back({{vertex, triangle}, beta, Vec3::Zero()});
  }
  void attach_column(int column, int from_row, int body, Real beta) {
    for (int row = from_row; row < kRows; ++row) attach(vertex(row, column), triangle_of(body), beta);
  }
  Real value(const Claim& claim) const { return cosim::measure(claim, world, state, {}); }
};
const Claim kOnLeft{.quantity = Quantity::attached, .things = {"tape", "left"}};
const Claim kOnRight{.quantity = Quantity::attached, .things = {"tape", "right"}};
const Claim kOnAny{.quantity = Quantity::attached, .things = {"tape"}};
/// Along x of the world, which is -y of the left body.
const Claim kSeam{.quantity = Quantity::seam, .things = {"tape", "left", "right"}, .along = Vec3(0, -1, 0)};
}  // namespace

/// An outer column of a strip of two cells stands for half a cell of two: a quarter of the area.
TEST(Measure, AttachedIsTheShareOfAreaWithMoreThanHalfOfItsEngagement) {
  Sealed strip;
  EXPECT_EQ(strip.value(kOnAny), 0);
  strip.attach_column(0, 0, 0, 0.6);
  strip.attach_column(2, 0, 1, 0.5);
  EXPECT_NEAR(strip.value(kOnLeft), 0.25, 1e-12);
  EXPECT_EQ(strip.value(kOnRight), 0) << "half is not more than half";
  EXPECT_NEAR(strip.value(kOnAny), 0.25, 1e-12);
  strip.attach_column(2, 0, 1, 0.9);
  EXPECT_NEAR(strip.value(kOnRight), 0.25, 1e-12);
  EXPECT_NEAR(strip.value(kOnAny), 0.5, 1e-12);
}
/// A corner of a box on a triangle of the strip: the area of its three vertices counts, each a third of the triangles around it.
TEST(Measure, AttachedCountsTheTriangleThatACornerOfABodyAdheresTo) {
  Sealed strip;
  strip.attach(strip.world.assembly.bodies[1].first_vertex, strip.world.assembly.strips[0].first_triangle, 1);
  Real area = 0;
  const tape::Index3& t = strip.world.assembly.triangles[0];
  for (int k = 0; k < 3; ++k) area += strip.world.surface.vertices[static_cast<std::size_t>(t[k])].area;
  EXPECT_NEAR(strip.value(kOnRight), area / (4 * kCell * tape::test::vinyl().width), 1e-12);
  EXPECT_EQ(strip.value(kOnLeft), 0);
}
TEST(Measure, ASeamIsCoveredWhereTheStripAdheresOnBothSides) {
  Sealed strip;
  strip.attach_column(0, 0, 0, 1);  // 0 to 0.04 m on the left
  EXPECT_EQ(strip.value(kSeam), 0) << "nothing holds on the right";
  strip.attach(strip.vertex(0, 2), strip.triangle_of(1), 1);
  EXPECT_EQ(strip.value(kSeam), 0) << "a point has no length";
  strip.attach_column(2, 2, 1, 1);  // 0.02 to 0.04 m on the right
  EXPECT_NEAR(strip.value(kSeam), 0.02, 1e-12);
  Claim across = kSeam;
  across.along = Vec3::UnitX();  // y of the world: the columns have no length along it
  EXPECT_NEAR(strip.value(across), 0, 1e-12);
}
/// Rows at steps of 1.9 rad about the y axis of the world, which is x of the left body, through that body's middle.
TEST(Measure, TurnsAreWhatAdheresAboutAnAxis) {
  Sealed strip;
  const Claim turns{.quantity = Quantity::turns, .things = {"tape", "left"}, .along = Vec3::UnitX()};
  constexpr Real kStep = 1.9, kRadius = 0.012, kPerStep = kStep / (2 * std::numbers::pi);
  for (int row = 0; row < kRows; ++row)
    for (int column = 0; column < kColumns; ++column) {
      const Vec3 on_circle(kRadius * std::cos(row * kStep), 0.01 * (column - 1), -kRadius * std::sin(row * kStep));
      strip.state.x[static_cast<std::size_t>(strip.vertex(row, column))] = Vec3(0.02, -0.0515, -0.01) + on_circle;
    }
  EXPECT_EQ(strip.value(turns), 0) << "nothing adheres";
  strip.attach_column(0, 0, 0, 1);
  EXPECT_EQ(strip.value(turns), 0) << "an edge of the strip is no area";
  for (int column : {1, 2}) strip.attach_column(column, 2, 1, 1);
  EXPECT_NEAR(strip.value(turns), 2 * kPerStep, 0.26 * kPerStep) << "rows 2 to 4, and a triangle of the row before";
  for (int column : {1, 2}) strip.attach_column(column, 0, 0, 1);
  EXPECT_NEAR(strip.value(turns), 4 * kPerStep, 1e-12) << "more than once around";
  Claim along = turns;
  along.along = Vec3::UnitY();
  EXPECT_LT(strip.value(along), 4 * kPerStep - 0.1) << "about another axis";
}
/// A plate that a script carries bears the block that lies on it.
TEST(Measure, ForceOnADrivenBodyIsWhatItBears) {
  tape::Setup setup = tape::test::strip_setup(tape::test::flat_strip(0.02, 2, Vec3(1, 0, 0)));
  setup.scene.gravity = Vec3(0, 0, -9.81);
  setup.newton.velocity_tol = 1e-4;
  setup.scene.strips[0].velocity = Vec3::Zero();
  tape::test::add_body(setup, "plate", tape::box_mesh(Vec3(0.06, 0.06, 0.01), {1, 1, 1}), tape::Motion::driven, Vec3(0, 0, -0.005));
  tape::Body& block =
      tape::test::add_body(setup, "block", tape::box_mesh(Vec3(0.02, 0.02, 0.02), {1, 1, 1}), tape::Motion::dynamic, Vec3(0, 0, 0.0101));
  block.mass = 0.05;
  const tape::World world = tape::World::build(setup);
  tape::State state = tape::State::start(world);
  const auto stepper = tape::make_stepper(tape::Backend::cpu, world);
  tape::StepReport report;
  for (int k = 0; k < 40; ++k) {
    report = stepper->step(state);
    ASSERT_TRUE(report.ok) << report.failure;
  }
  const auto force = [&](const char* body) {
    return cosim::measure({.quantity = Quantity::force, .things = {body}}, world, state, report);
  };
  EXPECT_NEAR(force("plate"), 0.05 * 9.81, 0.01 * 0.05 * 9.81);
  EXPECT_NEAR(force("block"), 0.05 * 9.81, 0.01 * 0.05 * 9.81);
  EXPECT_LT(report.body_force[0].z(), 0);
}
TEST(Measure, PiecesAreWhatHangsTogetherByTriangles) {
  Sealed strip;
  const Claim pieces{.quantity = Quantity::pieces, .things = {"tape"}};
  EXPECT_EQ(strip.value(pieces), 1);
  auto& triangles = strip.world.assembly.triangles;  // cut: the third row of cells is gone
  const auto spans_the_cut = [](const tape::Index3& t) {
    const auto [low, high] = std::minmax({t[0], t[1], t[2]});
    return low / kColumns == 2 && high / kColumns == 3;
  };
  tape::StripPart& part = strip.world.assembly.strips[0];
  const auto end = triangles.begin() + part.triangles;
  const auto gone = std::distance(std::remove_if(triangles.begin(), end, spans_the_cut), end);
  ASSERT_EQ(gone, 4);
  part.triangles -= static_cast<int>(gone);
  EXPECT_EQ(strip.value(pieces), 2);
}
TEST(Measure, AJointIsWhereItsRobotHasIt) {
  const Sealed strip;
  const Claim joint{.quantity = Quantity::joint, .things = {"b:second"}, .robot = 1, .joint = 1};
  const cosim::JointPositions q = {Eigen::VectorXd::Constant(1, 7.0), Eigen::Vector3d(1, 2, 3)};
  EXPECT_EQ(cosim::measure(joint, strip.world, strip.state, {}, q), 2);
}
