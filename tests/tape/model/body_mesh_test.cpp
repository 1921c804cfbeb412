#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "tape/core/error.hpp"
#include "tape/math/rotation.hpp"
#include "tape/model/mass_properties.hpp"
#include "tape/model/mesh_check.hpp"
#include "tape/model/primitives.hpp"
using namespace tape;

namespace {
constexpr Real kPi = std::numbers::pi;
/// Moves a mesh rigidly, far enough from the origin to show cancellation.
TriangleMesh moved(TriangleMesh mesh, const Pose& pose) {
  for (Vec3& v : mesh.vertices) v = apply(pose, v);
  return mesh;
}
const Pose kAway{rotation_exp({0.3, -1.2, 0.7}), {3, -2, 5}};
std::string refusal(const TriangleMesh& mesh, bool closed) {
  try {
    check_mesh(mesh, "body cup (cup.obj)", closed);
  } catch (const InputError& e) {
    return e.what();
  }
  return "";
}
}  // namespace

TEST(MassProperties, OfABoxAreExactInAnyPose) {
  const Vec3 size(0.1, 0.2, 0.05);
  for (const TriangleMesh& box : {box_mesh(size), box_mesh(size, {3, 1, 4})}) {
    const MassProperties m = mass_properties(moved(box, kAway));
    const Real volume = size.prod();
    const Mat3 second = volume / 12 * size.cwiseAbs2().asDiagonal().toDenseMatrix();
    EXPECT_NEAR(m.volume, volume, 1e-13 * volume);
    EXPECT_LT((m.centre - kAway.position).norm(), 1e-14);
    EXPECT_LT((m.second - kAway.rotation * second * kAway.rotation.transpose()).norm(), 1e-12 * second.norm());
  }
}

TEST(MassProperties, OfARingAreThoseOfItsPolygons) {
  const Real inner = 0.019, outer = 0.0211, height = 0.02;
  const int n = 96;
  const MassProperties m = mass_properties(ring_mesh(inner, outer, height, n, 2));
  // A regular n-gon of circumradius r: area n/2 r^2 sin(2 pi/n), second moment about an axis in its plane n/48 r^4 sin(2 pi/n) (4 + 2 cos(2
  // pi/n)).
  const Real angle = 2 * kPi / n;
  const auto area = [&](Real r) { return n / 2.0 * r * r * std::sin(angle); };
  const auto moment = [&](Real r) { return n / 48.0 * std::pow(r, 4) * std::sin(angle) * (4 + 2 * std::cos(angle)); };
  const Real volume = height * (area(outer) - area(inner)), across = height * (moment(outer) - moment(inner));
  EXPECT_NEAR(m.volume, volume, 1e-12 * volume);
  EXPECT_NEAR(m.second(0, 0), across, 1e-10 * across);
  EXPECT_NEAR(m.second(1, 1), across, 1e-10 * across);
  EXPECT_NEAR(m.second(2, 2), volume * height * height / 12, 1e-12 * across);
  EXPECT_NEAR(m.second(0, 1), 0, 1e-12 * across);
}

TEST(MassProperties, OfASphereConvergeWithTheSquareOfItsCells) {
  const Real radius = 0.3, volume = 4 * kPi / 3 * std::pow(radius, 3), second = volume * radius * radius / 5;
  Real last = 0;
  for (int s = 1; s <= 5; ++s) {
    const MassProperties m = mass_properties(sphere_mesh(radius, s));
    const Real error = 1 - m.volume / volume;
    EXPECT_GT(error, 0) << "inscribed";
    if (s > 1) {
      EXPECT_NEAR(last / error, 4, 0.4) << s;
    }
    last = error;
  }
  const MassProperties m = mass_properties(sphere_mesh(radius, 5));
  EXPECT_NEAR(m.volume / volume, 1, 1e-3);
  EXPECT_LT((m.second - second * Mat3::Identity()).norm(), 3e-3 * second);
}

TEST(Primitives, AreClosedManifoldOutwardAndAsLargeAsTheyShouldBe) {
  const int n = 400;
  const struct {
    const char* name;
    TriangleMesh mesh;
    Real volume;
  } solids[] = {
      {"box", box_mesh({0.1, 0.2, 0.3}, {2, 3, 4}), 0.006},
      {"cylinder", cylinder_mesh(0.1, 0.3, n, 3), kPi * 0.003},
      {"ring", ring_mesh(0.05, 0.1, 0.3, n, 1), kPi * 0.00225},
      {"sphere", sphere_mesh(0.1, 5), 4 * kPi / 3 * 1e-3},
      {"capsule", capsule_mesh(0.1, 0.3, n), kPi * 0.003 + 4 * kPi / 3 * 1e-3},
      {"wedge", wedge_mesh({0.1, 0.2, 0.3}), 0.003},
      {"spike", spike_mesh(0.1, 0.3, n), kPi * 0.001},
  };
  for (const auto& solid : solids) {
    EXPECT_NO_THROW(check_mesh(solid.mesh, solid.name, true));
    EXPECT_NEAR(mass_properties(solid.mesh).volume, solid.volume, 1e-3 * solid.volume) << solid.name;
  }
  EXPECT_NO_THROW(check_mesh(sheet_mesh({0.1, 0.2}, {4, 5}), "sheet", false));
}

TEST(Primitives, ARingHasARealBore) {
  for (const Vec3& v : ring_mesh(0.019, 0.0211, 0.02, 48, 2).vertices) EXPECT_GE(v.head<2>().norm(), 0.019 * (1 - 1e-12));
}

TEST(MeshCheck, NamesBodyTriangleAndReason) {
  TriangleMesh box = box_mesh({1, 1, 1});
  const struct {
    std::string reason;
    bool closed;
    void (*spoil)(TriangleMesh&);
  } cases[] = {
      {"vertex 3 is not finite", false, [](TriangleMesh& m) { m.vertices[3].y() = std::numeric_limits<Real>::quiet_NaN(); }},
      {"vertex 3 is not finite", false, [](TriangleMesh& m) { m.vertices[3].y() = std::numeric_limits<Real>::infinity(); }},
      {"triangle 2 names vertex 8 of 8", false, [](TriangleMesh& m) { m.triangles[2][1] = 8; }},
      {"triangle 2 names vertex -1", false, [](TriangleMesh& m) { m.triangles[2][1] = -1; }},
      {"triangle 4 is degenerate", false, [](TriangleMesh& m) { m.triangles[4][1] = m.triangles[4][0]; }},
      {"triangle 0 is degenerate", false,
       [](TriangleMesh& m) { m.vertices[m.triangles[0][0]] = (m.vertices[m.triangles[0][1]] + m.vertices[m.triangles[0][2]]) / 2; }},
      {"triangle 12 is the same as triangle 5", false, [](TriangleMesh& m) { m.triangles.push_back(m.triangles[5]); }},
      {"is not manifold: 3 triangles", false,
       [](TriangleMesh& m) {
         m.vertices.push_back({2, 2, 2}), m.triangles.push_back({m.triangles[0][0], m.triangles[0][1], 8});
       }},
      {"is oriented against its neighbour", false, [](TriangleMesh& m) { std::swap(m.triangles[7][0], m.triangles[7][1]); }},
      {"vertex 8 belongs to no triangle", false,
       [](TriangleMesh& m) {
         m.vertices.push_back({2, 2, 2});
       }},
      {"is open", true, [](TriangleMesh& m) { m.triangles.pop_back(); }},
      {"face inward", true,
       [](TriangleMesh& m) {
         for (Index3& t : m.triangles) std::swap(t[0], t[1]);
       }},
      {"has no triangles", false, [](TriangleMesh& m) { m.triangles.clear(); }},
  };
  EXPECT_EQ(refusal(box, true), "");
  for (const auto& c : cases) {
    TriangleMesh spoilt = box;
    c.spoil(spoilt);
    const std::string message = refusal(spoilt, c.closed);
    EXPECT_EQ(message.find("body cup (cup.obj): "), 0u) << c.reason;
    EXPECT_NE(message.find(c.reason), std::string::npos) << "expected: " << c.reason << "\ngot: " << message;
  }
  box.triangles.pop_back();
  EXPECT_EQ(refusal(box, false), "") << "an open surface is fine where no mass is needed";
}
