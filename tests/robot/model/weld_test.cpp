#include "robot/model/weld.hpp"

#include <gtest/gtest.h>

#include <numbers>

#include "robot/kinematics/forward_kinematics.hpp"
#include "robot/model/inertia.hpp"
using namespace robot;

namespace {
Inertial ball(Real mass, const Vec3& com) { return {mass, com, 0.01 * mass * Mat3::Identity()}; }
/// A base and an arm of 1 m along x that turns about z, with a frame at its end.
RobotModel arm() {
  RobotModel model{.name = "arm", .links = {{.name = "base"}, {.name = "upper", .inertial = ball(2, Vec3(0.5, 0, 0))}}};
  model.joints = {{.name = "shoulder", .axis = Vec3::UnitZ()}};
  model.frames = {{"flange", 1, Pose(Eigen::Translation3d(1, 0, 0))}};
  return model;
}
/// A body with a lid 0.2 m above it that turns about x.
RobotModel tool() {
  RobotModel model{.name = "tool",
                   .links = {{.name = "body", .inertial = ball(1, Vec3(0, 0, 0.1))}, {.name = "lid", .inertial = ball(0.5, Vec3::Zero())}}};
  model.joints = {{.name = "hinge", .X_PJ = Pose(Eigen::Translation3d(0, 0, 0.2)), .axis = Vec3::UnitX()}};
  model.frames = {{"rim", 1, Pose(Eigen::Translation3d(0, 0.3, 0))}};
  model.may_overlap = {{0, 1}};
  return model;
}
}  // namespace

TEST(Weld, TheToolMovesWithTheLinkThatCarriesIt) {
  const Pose X_FT(Eigen::Translation3d(0.1, 0, 0));
  const RobotModel both = weld(arm(), "flange", tool(), X_FT);
  ASSERT_EQ(both.links.size(), 3u);
  ASSERT_EQ(both.joints.size(), 2u);
  VecX q(2);
  q << std::numbers::pi / 2, std::numbers::pi / 2;
  const std::vector<Pose> poses = link_poses(both, q, Pose::Identity());
  EXPECT_TRUE(frame_pose(poses, *both.find_frame("body")).translation().isApprox(Vec3(0, 1.1, 0), 1e-12));
  // The arm points along y, the tool's x as well; the lid's y axis has turned up.
  EXPECT_TRUE(frame_pose(poses, *both.find_frame("rim")).translation().isApprox(Vec3(0, 1.1, 0.5), 1e-12));
}
TEST(Weld, MassIsThatOfBoth) {
  const RobotModel both = weld(arm(), "flange", tool(), Pose::Identity());
  const Inertial& carrier = both.links[1].inertial;
  EXPECT_DOUBLE_EQ(carrier.mass, 3);
  EXPECT_TRUE(carrier.com.isApprox(Vec3((2 * 0.5 + 1) / 3, 0, 0.1 / 3), 1e-12));
  // About z: 0.02 + 0.01 of the balls, and the reduced mass 2/3 kg at a distance of 0.5 m in the plane.
  EXPECT_NEAR(carrier.inertia(2, 2), 0.03 + 2.0 / 3 * 0.25, 1e-12);
  EXPECT_EQ(both.may_overlap, (std::vector<std::pair<int, int>>{{1, 2}}));
  EXPECT_EQ(both.notes.back(), "tool is welded to flange");
}
TEST(Weld, NamesThatBothHaveAndFramesThatNeitherHasAreRefused) {
  RobotModel same = tool();
  same.links[1].name = "upper";
  EXPECT_THROW(weld(arm(), "flange", same, Pose::Identity()), InputError);
  EXPECT_THROW(weld(arm(), "wrist", tool(), Pose::Identity()), InputError);
}
