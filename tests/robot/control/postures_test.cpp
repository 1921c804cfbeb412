#include "robot/control/postures.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/robot/support/folder.hpp"
using namespace robot;
using testing::EndsWith;
using testing::HasSubstr;
using testing::ThrowsMessage;

namespace {
/// A hand of five fingers with four joints each, and a wrist.
RobotModel hand(const std::string& prefix) {
  RobotModel model;
  model.name = "hand";
  model.links = {{.name = "palm"}, {.name = "forearm"}};
  model.joints = {{.name = "wrist"}};
  for (int finger = 1; finger <= 5; ++finger)
    for (int joint = 1; joint <= 4; ++joint) {
      model.links.push_back({});
      model.joints.push_back({.name = prefix + "finger" + std::to_string(finger) + "_joint" + std::to_string(joint),
                              .parent = joint == 1 ? 0 : static_cast<int>(model.links.size()) - 2,
                              .lower = joint == 1 ? -0.3 : 0,
                              .upper = joint == 1 ? 0.4 : 1.6,
                              .velocity = 8});
    }
  return model;
}
RobotModel two_joints() {
  RobotModel model;
  model.name = "claw";
  model.links = {{.name = "palm"}, {.name = "a"}, {.name = "b"}};
  model.joints = {{.name = "l_a", .lower = -0.2, .upper = 1}, {.name = "l_b", .lower = 0, .upper = 2, .velocity = 3}};
  return model;
}
const std::filesystem::path kHandFile = TAPE_SOURCE_DIR "/data/robots/hand_postures.yaml";
}  // namespace

TEST(Postures, ThoseOfTheHandFitEverySideAndNameAllTwentyJoints) {
  const HandPostures postures = read_postures(kHandFile);
  for (const char* name : {"open", "pinch", "cup", "press"})
    for (const char* prefix : {"left_", "right_", ""}) {
      const RobotModel model = hand(prefix);
      const VecX q = postures.angles(model, prefix, name);
      EXPECT_EQ(q.size(), 20);
      EXPECT_EQ(postures.joints_of(prefix)[4], std::string(prefix) + "finger2_joint1");
    }
  EXPECT_EQ(postures.angles(hand(""), "", "open"), VecX::Zero(20));
}

TEST(Postures, AFractionIsOfTheWayFromZeroToTheLimitOnItsSide) {
  const HandPostures postures =
      read_postures(test::TextFile("unit: fraction\npostures:\n  grip: {a: -0.5, b: 0.25}\n  flat: {b: 0, a: 1}\n"));
  EXPECT_EQ(postures.angles(two_joints(), "l_", "grip"), VecX(Eigen::Vector2d(-0.1, 0.5)));
  EXPECT_EQ(postures.angles(two_joints(), "l_", "flat"), VecX(Eigen::Vector2d(1, 0)));
}

TEST(Postures, WhereZeroIsBeyondALimitFractionsStartAtThatLimit) {
  const HandPostures postures = read_postures(test::TextFile("postures:\n  flat: {a: 0, b: 0.5}\n"));
  RobotModel model = two_joints();
  model.joints[0].lower = 0.05, model.joints[1].lower = 1;
  EXPECT_EQ(postures.angles(model, "l_", "flat"), VecX(Eigen::Vector2d(0.05, 1.5)));
}

TEST(Postures, AnglesInRadiansAreTakenAsTheyAre) {
  const HandPostures postures = read_postures(test::TextFile("postures:\n  grip: {a: -0.15, b: 1.75}\nunit: rad\n"));
  EXPECT_EQ(postures.angles(two_joints(), "l_", "grip"), VecX(Eigen::Vector2d(-0.15, 1.75)));
}

TEST(Postures, AMoveEndsInThePostureAtRestAfterItsDuration) {
  const HandPostures postures = read_postures(kHandFile);
  const RobotModel model = hand("left_");
  const VecX open = postures.angles(model, "left_", "open"), cup = postures.angles(model, "left_", "cup");
  const JointTrajectory move = postures.move(model, "left_", open, "cup", 0.8);
  EXPECT_EQ(move.joints, postures.joints_of("left_"));
  EXPECT_EQ(move.at(0).q, open);
  EXPECT_LT((move.at(0.4).q - (open + cup) / 2).norm(), 1e-15);
  EXPECT_EQ(move.at(0.8).q, cup);
  EXPECT_EQ(move.at(0.8).v.norm(), 0);
  EXPECT_THAT([&] { postures.move(model, "left_", open, "cup", 0.01); }, ThrowsMessage<InputError>(HasSubstr("(allowed: 8 and inf)")));
}

TEST(Postures, UnknownNamesAndValuesOutOfRangeAreRefused) {
  const HandPostures postures = read_postures(test::TextFile("unit: rad\npostures:\n  grip: {a: 0, b: 2.5}\n"));
  EXPECT_THAT([&] { postures.angles(two_joints(), "l_", "fist"); },
              ThrowsMessage<InputError>(EndsWith("there is no posture fist (allowed: grip)")));
  EXPECT_THAT([&] { postures.angles(two_joints(), "r_", "grip"); }, ThrowsMessage<InputError>(EndsWith("robot claw has no joint r_a")));
  EXPECT_THAT([&] { postures.angles(two_joints(), "l_", "grip"); },
              ThrowsMessage<InputError>(EndsWith("joint l_b = 2.5 rad (allowed: 0 to 2 rad, finite)")));
}

TEST(Postures, WhatIsWrongInAFileIsSaidWithLineAndKey) {
  const std::pair<std::string, std::string> wrong[] = {
      {"unit: fraction\n", ":1: postures: is missing"},
      {"unit: degree\npostures: {}\n", ":1: unit: degree (allowed: fraction, rad)"},
      {"postures: {}\n", ":1: postures: is empty (allowed: at least one)"},
      {"poses: {}\n", ":1: poses: is unknown (allowed: unit, postures)"},
      {"postures:\n  a: 3\n", ":2: postures.a: is no section of keys and values"},
      {"postures:\n  a: {j: x}\n", ":2: postures.a.j: is no finite number"},
      {"postures:\n  a: {j: 1.2}\n", ":2: postures.a.j: 1.2 (allowed: -1 to 1)"},
      {"postures:\n  a: {j: 1, j: 0}\n", ":2: postures.a.j: is there twice"},
      {"postures:\n  a: {j: 1}\n  a: {j: 0}\n", ":3: postures.a: is there twice"},
      {"postures:\n  a: {j: 1, k: 0}\n  b: {j: 0}\n", ":3: postures.b: joint k is missing"},
      {"postures:\n  a: {j: 1}\n  b: {j: 0, k: 0}\n", ":3: postures.b.k: is no joint of the first posture"}};
  for (const auto& [text, reason] : wrong)
    EXPECT_THAT([t = text] { read_postures(test::TextFile(t)); }, ThrowsMessage<InputError>(EndsWith(reason))) << text;
  EXPECT_THAT([] { read_postures(test::TextFile("postures: {a\n")); }, ThrowsMessage<InputError>(HasSubstr("not valid YAML")));
  EXPECT_THAT([] { read_postures("nowhere.yaml"); }, ThrowsMessage<InputError>(HasSubstr("nowhere.yaml: cannot be read")));
}
