#include "tape/contact/containment.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tape/core/error.hpp"
#include "tape/model/primitives.hpp"
#include "tests/tape/contact/meshes.hpp"
using namespace tape;

namespace {
void add(test::Surface& s, const TriangleMesh& mesh) { test::add_object(s, mesh.vertices, mesh.triangles, 0); }
}  // namespace

TEST(Containment, ABoxInABoxIsRefusedOneBesideItIsNot) {
  test::Surface inside, beside;
  add(inside, box_mesh({1, 1, 1}));
  add(inside, box_mesh({0.1, 0.1, 0.1}));
  EXPECT_THROW(check_nothing_inside(inside.x, inside.mesh), InputError);
  TriangleMesh away = box_mesh({0.1, 0.1, 0.1});
  for (Vec3& v : away.vertices) v.x() += 2;
  add(beside, box_mesh({1, 1, 1}));
  add(beside, away);
  EXPECT_NO_THROW(check_nothing_inside(beside.x, beside.mesh));
}

TEST(Containment, AnOpenSurfaceEnclosesNothingHoweverOftenItIsWound) {
  test::Surface s;  // six turns see a solid angle of some 6 times 4 pi sin(atan(1/2)) from their middle
  test::add_strip(s, 201, 7, 1.0 / 6, 0, [](int row) {
    const Real angle = 12 * std::numbers::pi * row / 200;
    return Vec2((1 + 0.01 * angle) * Vec2(std::cos(angle), std::sin(angle)));
  });
  TriangleMesh ball = sphere_mesh(0.1, 1);
  for (Vec3& v : ball.vertices) v.z() += 0.5;
  add(s, ball);
  EXPECT_NO_THROW(check_nothing_inside(s.x, s.mesh));
}
