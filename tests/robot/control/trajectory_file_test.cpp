#include "robot/control/trajectory_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numbers>

#include "tests/robot/support/folder.hpp"
using namespace robot;
using testing::EndsWith;
using testing::HasSubstr;
using testing::ThrowsMessage;

namespace {
RobotModel crane() {
  RobotModel model;
  model.name = "crane";
  model.links = {{.name = "base"}, {.name = "boom"}, {.name = "arm"}, {.name = "trolley"}};
  model.joints = {{.name = "swing", .lower = -2, .upper = 2},
                  {.name = "luff", .parent = 1},
                  {.name = "slide", .type = JointType::prismatic, .parent = 2}};
  return model;
}
JointTrajectory read(const std::string& text) { return read_trajectory(test::TextFile(text), crane(), {"swing", "slide"}); }
}  // namespace

TEST(TrajectoryFile, ColumnsComeInTheOrderAskedForAndInRadiansAndMetres) {
  const JointTrajectory path = read("# recorded\n\ntime_s, slide [m], swing [deg]\r\n1.5,0.25,90\n1.55 , 0.3,-45\n\n1.6,0.1,1e1\n");
  EXPECT_EQ(path.joints, (std::vector<std::string>{"swing", "slide"}));
  EXPECT_EQ(path.times, (std::vector<Real>{1.5, 1.55, 1.6}));
  EXPECT_DOUBLE_EQ(path.knots[0][0], std::numbers::pi / 2);
  EXPECT_DOUBLE_EQ(path.knots[1][0], -std::numbers::pi / 4);
  EXPECT_DOUBLE_EQ(path.knots[2][0], std::numbers::pi / 18);
  EXPECT_EQ(path.knots[0][1], 0.25);
}

TEST(TrajectoryFile, SpreadsheetsMarkTheOrderOfBytesFirst) {
  const test::TextFile file("\xEF\xBB\xBFtime_s,slide [m],swing [rad]\n0,0.1,0.2\n0.05,0.1,0.2\n");
  EXPECT_EQ(joints_in_header(file), (std::vector<std::string>{"slide", "swing"}));
  EXPECT_EQ(read_trajectory(file, crane(), joints_in_header(file)).knots[0], Eigen::Vector2d(0.1, 0.2));
}

TEST(TrajectoryFile, BetweenRowsPositionsAreLinearAndVelocityIsTheirDifference) {
  const JointTrajectory path = read("time_s,swing [rad],slide [m]\n0,0,0\n0.04,0.2,-0.1\n0.08,1,0\n");
  const auto point = path.at(0.05);
  EXPECT_NEAR(point.q[0], 0.4, 1e-15);
  EXPECT_NEAR(point.v[0], 20, 1e-12);
  EXPECT_NEAR(path.at(0.04).v[0], 20, 1e-12);  // at a row: of what follows
  EXPECT_NEAR(path.at(0).v[0], 5, 1e-12);
  const std::vector<VecX> q = sample(path);
  ASSERT_EQ(q.size(), 9u);
  EXPECT_NEAR(q[1][0], 0.05, 1e-15);
  EXPECT_NEAR(q[7][1], -0.025, 1e-15);
  EXPECT_EQ(q[8][0], 1);
}

TEST(TrajectoryFile, WhatIsWrongIsSaidWithFileLineAndColumn) {
  const std::string header = "time_s,swing [rad],slide [m]\n0,0,0\n";
  const std::pair<std::string, std::string> wrong[] = {
      {"", "is empty (allowed: a header and at least two rows)"},
      {"t,swing [rad],slide [m]\n", ":1: column 1 (t): the first column is the time (allowed: time_s)"},
      {"time_s,swing,slide [m]\n", ":1: column 2 (swing): has no unit (allowed: name [rad], name [deg], name [m])"},
      {"time_s,swing [mm],slide [m]\n", ":1: column 2 (swing [mm]): unit mm (allowed: rad, deg)"},
      {"time_s,swing [rad],slide [deg]\n", ":1: column 3 (slide [deg]): unit deg (allowed: m)"},
      {"time_s,swing [rad],slide [m],hook [rad]\n", ":1: column 4 (hook [rad]): is no joint that this motion has"},
      {"time_s,swing [rad],slide [m],luff [rad]\n", ":1: column 4 (luff [rad]): is no joint that this motion has"},
      {"time_s,swing [rad],slide [m],swing [deg]\n", ":1: column 4 (swing [deg]): is there twice"},
      {"#\ntime_s,swing [rad]\n", ":2: joint slide is missing"},
      {"time_s,swing [rad],slide [m],\n", ":1: column 4 (): has no unit (allowed: name [rad], name [deg], name [m])"},
      {header, ": has 1 rows (allowed: at least 2)"},
      {header + "0.1,0\n", ":3: has 2 columns, the header 3"},
      {header + "0.1,,0\n", ":3: column 2 (swing): is empty"},
      {header + "0.1,0,nan\n", ":3: column 3 (slide): nan is no finite number"},
      {header + "0.1,0,inf\n", ":3: column 3 (slide): inf is no finite number"},
      {header + "0.1,0.5x,0\n", ":3: column 2 (swing): 0.5x is no finite number"},
      {header + "0.1,0,0\n0.1,0,0\n", ":4: column 1 (time_s): 0.1 s is not after 0.1 s"},
      {header + "0.1,0,0\n0.05,0,0\n", ":4: column 1 (time_s): 0.05 s is not after 0.1 s"},
      {header + "0.1,0,0\n0.25,0,0\n", ":4: column 1 (time_s): a gap of 0.15 s before 0.25 s (allowed: up to 0.1 s)"},
      {header + "\n0.1,2.1,0\n", ":4: column 2 (swing): joint swing = 2.1 is beyond its limits (allowed: -2 to 2 rad or m)"}};
  for (const auto& [text, reason] : wrong) EXPECT_THAT([t = text] { read(t); }, ThrowsMessage<InputError>(EndsWith(reason))) << text;
  EXPECT_NO_THROW(read(header + "0.1,2.01,0\n"));  // within the slack
  EXPECT_THAT([] { read_trajectory("nowhere.csv", crane(), {}); }, ThrowsMessage<InputError>(HasSubstr("nowhere.csv: cannot be read")));
}

TEST(TrajectoryFile, ColumnsOfAnotherRobotDriveJointsByScaleAndOffset) {
  const test::TextFile file("i,t,pitch,other,lift\n0,2,0.5,x,100\n1,2.05,1,,300\n");
  const JointTrajectory path = read_table(file, crane(), "t", {{"slide", "lift", 1e-3}, {"swing", "pitch", -1, 0.25}});
  EXPECT_EQ(path.joints, (std::vector<std::string>{"slide", "swing"}));
  EXPECT_EQ(path.times, (std::vector<Real>{2, 2.05}));
  EXPECT_EQ(path.knots[0], VecX(Eigen::Vector2d(0.1, -0.25)));
  EXPECT_EQ(path.knots[1], VecX(Eigen::Vector2d(0.3, -0.75)));
}

TEST(TrajectoryFile, WhatIsWrongInATableOfAnotherRobotIsSaidWithFileLineAndColumn) {
  const std::pair<std::string, std::string> wrong[] = {
      {"", "is empty (allowed: a header and at least two rows)"},
      {"t,roll\n", ":1: column pitch is missing"},
      {"pitch\n", ":1: column t is missing"},
      {"t,pitch,pitch\n", ":1: column pitch is there twice"},
      {"t,pitch\n0,0\n\n0.1,x\n", ":4: column 2 (pitch): x is no finite number"},
      {"pitch,t\n0,0\n0.1,0.5\n", ":3: column 2 (t): a gap of 0.5 s before 0.5 s (allowed: up to 0.1 s)"},
      {"t,pitch\n0,0\n0.1,-1.5\n", ":3: column 2 (pitch): joint swing = 3 is beyond its limits (allowed: -2 to 2 rad or m)"}};
  for (const auto& [text, reason] : wrong)
    EXPECT_THAT(
        [t = text] {
          read_table(test::TextFile(t), crane(), "t", {{"swing", "pitch", -2}});
        },
        ThrowsMessage<InputError>(EndsWith(reason)))
        << text;
  EXPECT_THAT(
      [] {
        read_table(test::TextFile("t,pitch\n"), crane(), "t", {{"hook", "pitch"}});
      },
      ThrowsMessage<InputError>(EndsWith("robot crane has no joint hook")));
}
