#include "robot/control/vendor_recording.hpp"

#include <gmock/gmock.h>

#include <numbers>

#include "tests/robot/kinematics/arms.hpp"
#include "tests/robot/support/folder.hpp"
using namespace robot;
using testing::EndsWith;
using testing::ThrowsMessage;

namespace {
constexpr Real kDegree = std::numbers::pi / 180;
const std::vector<std::string> kJoints = {"joint1", "joint2", "joint3", "joint4", "joint5", "joint6", "joint7"};
constexpr auto kRecorded = VendorColumns::recorded;

std::string row(const std::string& x, const std::string& y, const std::string& z, const std::string& w = "0") {
  return "X " + x + "$Y " + y + "$Z " + z + "$A 2$B 3$C -4.5$U 5$V 6$W " + w + "$\n";
}
JointTrajectory read(const std::string& text, VendorColumns columns, Real period = 1e-3) {
  return read_vendor_recording(test::TextFile(text), test::seven_joint_arm(), kJoints, columns, {}, period);
}
}  // namespace

TEST(VendorRecording, ARecordedRowHasTwoCountersOfMillisecondsAndSevenAngles) {
  const JointTrajectory path =
      read("\nPoinType=9@2\n" + row("500.000000", "500.000000", "1", "7") + row("503", "503", "1.5", "-7"), kRecorded);
  EXPECT_EQ(path.joints, kJoints);
  EXPECT_EQ(path.times[0], 0);
  EXPECT_NEAR(path.times[1], 0.003, 1e-15);
  const Real angles[] = {1.5, 2, 3, -4.5, 5, 6, -7};
  for (int j = 0; j < 7; ++j) EXPECT_DOUBLE_EQ(path.knots[1][j], angles[j] * kDegree) << j;
}

TEST(VendorRecording, ACommandHasItsAnglesFirstAndOneRowPerPeriod) {
  const JointTrajectory path =
      read("PoinType=9@3\n" + row("1", "-1", "0") + row("1", "-1", "8") + row("1", "-1", "9"), VendorColumns::command, 0.02);
  EXPECT_NEAR(path.end(), 0.04, 1e-15);
  const Real angles[] = {1, -1, 9, 2, 3, -4.5, 5};
  for (int j = 0; j < 7; ++j) EXPECT_DOUBLE_EQ(path.knots[2][j], angles[j] * kDegree) << j;
}

TEST(VendorRecording, WhatIsWrongIsSaidWithFileLineAndColumn) {
  const std::string start = "PoinType=9@2\n" + row("1", "1", "0");
  const std::pair<std::string, std::string> wrong[] = {
      {"", "is empty (allowed: a line PoinType=9@rows, and the rows)"},
      {"PoinType=7@2\n", ":1: PoinType=7@2 (allowed: PoinType=9@rows)"},
      {"PoinType=9@x\n", ":1: PoinType=9@x (allowed: PoinType=9@rows)"},
      {start, ": has 1 rows (allowed: 2, as its first line says)"},
      {start + row("2", "2", "0") + row("3", "3", "0"), ": has 3 rows (allowed: 2, as its first line says)"},
      {start + "\nX 2$Y 2$Z 0$A 0$", ":4: column 5 (B): is missing (allowed: B number$)"},
      {start + "X 2$Y 2$A 0$", ":3: column 3 (Z): is missing (allowed: Z number$)"},
      {start + row("2", "2", "1e"), ":3: column 3 (Z): 1e is no finite number"},
      {start + row("2", "2", ""), ":3: column 3 (Z): is empty"},
      {start + row("2", "3", "0"), ":3: column 2 (Y): 3 differs from 2 of X"},
      {start + row("1", "1", "0"), ":3: column 1 (X): 0 s is not after 0 s"},
      {start + row("201", "201", "0"), ":3: column 1 (X): a gap of 0.2 s before 0.2 s (allowed: up to 0.1 s)"},
      {start + row("2", "2", "180"),
       ":3: column 3 (Z): joint joint1 = 3.14159 is beyond its limits (allowed: -2.96706 to 2.96706 rad or m)"},
      {start + "X 2$Y 2$Z 0$A 0$B 0$C 0$U 0$V 0$W 0$Q 0$\n", ":3: Q 0$ after the last column"}};
  for (const auto& [text, reason] : wrong)
    EXPECT_THAT([t = text] { read(t, kRecorded); }, ThrowsMessage<InputError>(EndsWith(reason))) << text;
  EXPECT_THAT([] { read_vendor_recording("nowhere.txt", test::seven_joint_arm(), kJoints, kRecorded); },
              ThrowsMessage<InputError>(EndsWith("nowhere.txt: cannot be read")));
  EXPECT_THAT([] { read_vendor_recording("a.txt", test::seven_joint_arm(), {"joint1"}, kRecorded); },
              ThrowsMessage<InputError>(EndsWith("a.txt: 1 joints asked for (allowed: 7)")));
}
