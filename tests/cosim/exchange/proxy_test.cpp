#include "cosim/exchange/proxy.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "robot/model/primitives.hpp"
#include "tape/model/mass_properties.hpp"
#include "tape/model/mesh_check.hpp"

using cosim::make_proxy;
using cosim::Proxy;
using robot::Vec3;

namespace {
constexpr double kRadius = 0.01, kLength = 0.04;  // [m]

robot::Pose at(double z) { return robot::Pose(Eigen::Translation3d(0, 0, z)); }
/// A cylinder along z and a sphere on each end.
robot::Link capped(double cylinder_radius, double sphere_radius) {
  robot::Link link{.name = "finger"};
  link.collision = {robot::cylinder_shape(cylinder_radius, kLength, at(0)), robot::sphere_shape(sphere_radius, at(-kLength / 2)),
                    robot::sphere_shape(sphere_radius, at(kLength / 2))};
  return link;
}
double volume(const Proxy& proxy) { return tape::mass_properties(proxy.mesh).volume; }
}  // namespace

TEST(Proxy, ACylinderWithASphereOnEachEndIsOneCapsule) {
  const Proxy proxy = make_proxy(capped(kRadius, kRadius));
  EXPECT_LT(proxy.mesh.vertices.size(), 300u);
  EXPECT_NO_THROW(check_mesh(proxy.mesh, "proxy", true));
  const double capsule = std::numbers::pi * kRadius * kRadius * (kLength + 4.0 / 3 * kRadius);
  EXPECT_NEAR(volume(proxy), capsule, 0.04 * capsule) << "of chords in place of arcs";
  for (const Vec3& p : proxy.mesh.vertices) {
    const double from_axis = (p - Vec3(0, 0, std::clamp(p.z(), -kLength / 2, kLength / 2))).norm();
    EXPECT_NEAR(from_axis, kRadius, 1e-3 * kRadius);
  }
  EXPECT_LT(proxy.error, kRadius * (1 - std::cos(16 * std::numbers::pi / 180)))
      << "162 directions leave gaps of 10 degrees, and corners of the sphere stand up to 6 beside them";
}
TEST(Proxy, ShapesWithRoomBetweenThemStayApart) {
  const Proxy dumbbell = make_proxy(capped(0.5 * kRadius, kRadius));
  const auto alone = [](const robot::Shape& shape) {
    robot::Link link{.name = "part"};
    link.collision = {shape};
    return make_proxy(link).mesh.vertices.size();
  };
  std::size_t sum = 0;
  for (const robot::Shape& shape : capped(0.5 * kRadius, kRadius).collision) sum += alone(shape);
  EXPECT_EQ(dumbbell.mesh.vertices.size(), sum);
  robot::Link corner{.name = "corner"};  // two boxes as an L
  corner.collision = {robot::box_shape(Vec3(0.02, 0.02, 0.1), at(0)),
                      robot::box_shape(Vec3(0.1, 0.02, 0.02), robot::Pose(Eigen::Translation3d(0.04, 0, -0.04)))};
  EXPECT_EQ(make_proxy(corner).mesh.vertices.size(), 16u);
}
TEST(Proxy, TwoBoxesThatMakeOneAreOne) {
  robot::Link bar{.name = "bar"};
  for (double z : {-0.01, 0.01}) bar.collision.push_back(robot::box_shape(Vec3(0.02, 0.02, 0.02), at(z)));
  const Proxy proxy = make_proxy(bar);
  EXPECT_EQ(proxy.mesh.vertices.size(), 8u);
  EXPECT_NEAR(volume(proxy), 0.02 * 0.02 * 0.04, 1e-12);
}
