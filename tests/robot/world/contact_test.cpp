// Contacts between what Bullet owns, and setting back.
#include <gtest/gtest.h>

#include "tests/robot/world/robots.hpp"
using namespace robot;
using namespace robot::test;

namespace {
const Vec3 kTable{1, 1, 0.1}, kBox{0.1, 0.08, 0.06};
int add_table(World& world) { return world.add_robot(box(kTable, 10), {.X_WB = at({0, 0, -0.05})}); }
/// A driven arm that pokes a box on a table, and a second box on top.
World poking() {
  World world;
  add_table(world);
  RobotModel model = tree();
  for (Link& link : model.links) link.collision = {box_shape({0.05, 0.05, 0.05}, at(link.inertial.com))};
  for (int a = 0; a < 6; ++a)
    for (int b = a + 1; b < 6; ++b) model.may_overlap.emplace_back(a, b);
  world.add_robot(std::make_shared<RobotModel>(model),
                  {.X_WB = at({0, 0, 0.2}), .drives = std::vector<DriveGains>(5, {.kp = 200, .kd = 5, .effort = 4})});
  world.add_robot(box(kBox, 0.3), {.X_WB = at({0.1, 0.1, 0.03}), .fixed_base = false});
  world.add_robot(box(kBox, 0.3), {.X_WB = at({0.11, 0.1, 0.091}, 0.5, {0, 0, 1}), .fixed_base = false});
  return world;
}
std::vector<JointCommand> sway(int i) {
  return std::vector<JointCommand>(5, {.kind = JointCommand::Kind::position, .position = 1.5 * std::sin(0.15 * i)});
}
}  // namespace

TEST(Contact, ABoxRestsOnATable) {
  World world;
  const int table = add_table(world);
  const int robot = world.add_robot(box(kBox, 0.3), {.X_WB = at({0.2, 0.1, 0.035}, 0.3, {0, 0, 1}), .fixed_base = false});
  for (int i = 0; i < 100; ++i) world.step(0.01);
  const RobotState s = world.state(robot);
  EXPECT_NEAR(s.X_WB.translation().z(), 0.03, 1e-5);
  EXPECT_LT(s.v.head<3>().norm(), 1e-4);
  EXPECT_NEAR(s.X_WB.linear()(2, 2), 1, 1e-9);
  Vec3 force = Vec3::Zero();
  for (const Contact& c : world.contacts()) {
    EXPECT_EQ(c.robot_a + c.robot_b, table + robot);
    force += c.robot_a == robot ? c.force : Vec3(-c.force);
  }
  EXPECT_LT((force - Vec3(0, 0, 0.3 * 9.81)).norm(), 0.005 * 0.3 * 9.81);
}

TEST(Contact, OverlapsAreFoundAsThingsStand) {
  World world;
  const int table = add_table(world);
  world.add_robot(box(kBox, 0.3), {.X_WB = at({0.2, 0.1, 0.022}), .fixed_base = false});   // 8 mm inside the table
  world.add_robot(box(kBox, 0.3), {.X_WB = at({-0.2, 0.1, 0.031}), .fixed_base = false});  // 1 mm above it
  const std::vector<Contact> overlaps = world.overlaps();
  ASSERT_FALSE(overlaps.empty());
  EXPECT_NEAR(overlaps[0].distance, -0.008, 2e-4) << "edges are rounded by 0.1 mm";
  for (const Contact& c : overlaps) {
    EXPECT_EQ(std::minmax(c.robot_a, c.robot_b), std::minmax(table, 1));
    EXPECT_TRUE(c.force.isZero(0));
  }
  world.set_contact(table, 0, 1, 0, false);
  EXPECT_TRUE(world.overlaps().empty());
}

TEST(Contact, ACylinderStandsAndASphereRests) {
  World world;
  add_table(world);
  Shape shape{.kind = Shape::Kind::cylinder, .size = {0.03, 0.03, 0.1}};
  for (int i = 0; i < 24; ++i)
    for (const Real z : {-0.05, 0.05}) {
      const Real angle = 2 * std::numbers::pi * i / 24;
      shape.mesh.vertices.emplace_back(0.03 * std::cos(angle), 0.03 * std::sin(angle), z);
    }
  RobotModel can{.name = "can"};
  can.links = {{.name = "can", .inertial = {0.2, Vec3::Zero(), box_inertia(0.2, {0.05, 0.05, 0.1})}, .collision = {shape}}};
  const int standing = world.add_robot(std::make_shared<RobotModel>(can), {.X_WB = at({0, 0, 0.052}), .fixed_base = false});
  RobotModel ball = can;
  ball.links[0].collision = {{.kind = Shape::Kind::sphere, .size = Vec3::Constant(0.03)}};
  const int lying = world.add_robot(std::make_shared<RobotModel>(ball), {.X_WB = at({0.2, 0, 0.03}), .fixed_base = false});
  for (int i = 0; i < 100; ++i) world.step(0.01);
  EXPECT_NEAR(world.state(standing).X_WB.translation().z(), 0.05, 5e-5);
  EXPECT_GT(world.state(standing).X_WB.linear()(2, 2), 1 - 1e-6);
  EXPECT_NEAR(world.state(lying).X_WB.translation().z(), 0.03, 5e-5);
}

TEST(Contact, ABoxSlidesOnASlopeSteeperThanItsFriction) {
  constexpr Real kMu = 0.4;
  for (const Real slope : {0.9 * std::atan(kMu), 1.2 * std::atan(kMu)}) {
    World world;
    const Pose tilt = at(Vec3::Zero(), slope, Vec3::UnitY());
    world.add_robot(box(kTable, 10), {.X_WB = tilt * at({0, 0, -0.05}), .friction = 0.8});
    const int robot = world.add_robot(box(kBox, 0.3), {.X_WB = tilt * at({0, 0, 0.03}), .fixed_base = false});
    world.set_friction(robot, 0, kMu * kMu / 0.8);  // of a pair, the geometric mean
    for (int i = 0; i < 30; ++i) world.step(0.01);
    const Real down = tilt.linear().col(0).dot(world.state(robot).v.head<3>());
    const Real expected = std::max(0.0, 0.3 * 9.81 * (std::sin(slope) - kMu * std::cos(slope)));
    EXPECT_NEAR(down, expected, 0.01 * expected + 1e-4) << "slope " << slope;
  }
}

TEST(Contact, MaskedPairsAndPairsThatMayOverlapPassThroughEachOther) {
  World world;
  const int table = add_table(world);
  const int robot = world.add_robot(box(kBox, 0.3), {.X_WB = at({0, 0, 0.03}), .fixed_base = false});
  for (int i = 0; i < 5; ++i) world.step(0.01);
  EXPECT_NEAR(world.state(robot).X_WB.translation().z(), 0.03, 1e-5);
  world.set_contact(robot, 0, table, 0, false);
  const Snapshot masked = world.save();
  world.step(0.1);
  EXPECT_LT(world.state(robot).X_WB.translation().z(), 0.03 - 0.04);
  EXPECT_TRUE(world.contacts().empty());
  world.restore(masked);
  world.set_contact(table, 0, robot, 0, true);
  world.step(0.1);
  EXPECT_NEAR(world.state(robot).X_WB.translation().z(), 0.03, 1e-5);
}

TEST(Contact, LinksOfOneRobotCollideUnlessTheyMayOverlap) {
  for (const bool may_overlap : {false, true}) {
    RobotModel gripper{.name = "gripper"};
    gripper.links = {{.name = "palm"}};
    for (const Real y : {-0.05, 0.05}) {
      const Inertial inertial{0.1, Vec3::Zero(), box_inertia(0.1, {0.02, 0.02, 0.02})};
      gripper.links.push_back({.name = "jaw", .inertial = inertial, .collision = {box_shape({0.02, 0.02, 0.02})}});
      gripper.joints.push_back({.name = "slide", .type = JointType::prismatic, .X_PJ = at({0, y, 0}), .axis = {0, y > 0 ? -1.0 : 1.0, 0}});
    }
    if (may_overlap) gripper.may_overlap = {{1, 2}};
    World world({.gravity = Vec3::Zero()});
    const int robot = world.add_robot(std::make_shared<RobotModel>(gripper));
    for (int i = 0; i < 60; ++i) world.step(0.01, {VecX::Constant(2, 0.1)});
    if (may_overlap)
      EXPECT_GT(world.state(robot).q[0], 0.1);
    else
      EXPECT_NEAR(world.state(robot).q[0], 0.04, 1e-4);
  }
}

TEST(SettingBack, AStepRepeatedFromASnapshotIsTheSameToTheBit) {
  World world = poking();
  std::size_t touching = 0;
  for (int i = 0; i < 60; ++i) {
    world.command(1, sway(i));
    const Snapshot start = world.save();
    const VecX push = odd_numbers(5, 0.3);
    world.step(0.01, {VecX(), push, VecX(), VecX()});
    const Snapshot once = world.save();
    touching += world.contacts().size();
    world.restore(start);
    world.step(0.004);  // somewhere else
    world.restore(start);
    world.step(0.01, {VecX(), push, VecX(), VecX()});
    ASSERT_EQ(world.save().numbers, once.numbers) << "step " << i;
  }
  EXPECT_GT(touching, 100U);
}

TEST(SettingBack, AnotherWorldGoesOnFromASnapshotToTheBit) {
  World one = poking(), other = poking();
  for (int i = 0; i < 40; ++i) {
    one.command(1, sway(i));
    one.step(0.01);
  }
  ASSERT_NE(one.saturation(1), std::vector<int>(5, 0));
  other.restore(one.save());
  EXPECT_EQ(one.response(1, 0.01), other.response(1, 0.01));
  for (int i = 0; i < 20; ++i) {
    one.step(0.01);
    other.step(0.01);
    ASSERT_EQ(one.save().numbers, other.save().numbers);
  }
}

TEST(SettingBack, AForceOfZeroIsNoForce) {
  World one = poking(), other = poking();
  one.step(0.1);
  other.step(0.1, {VecX::Zero(0), VecX::Zero(5), VecX::Zero(6), VecX::Zero(6)});
  EXPECT_EQ(one.save().numbers, other.save().numbers);
}

TEST(SettingBack, TwoRunsAreTheSameToTheBit) {
  World one = poking(), other = poking();
  for (int i = 0; i < 60; ++i)
    for (World* world : {&one, &other}) {
      world->command(1, sway(i));
      world->step(0.01);
    }
  EXPECT_EQ(one.save().numbers, other.save().numbers);
}
