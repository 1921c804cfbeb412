#include "cosim/scene/script.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <limits>

#include "cosim/scene/read_scene.hpp"
#include "tape/core/error.hpp"
#include "tape/model/motion.hpp"
using namespace cosim;

namespace {
constexpr double kNever = std::numeric_limits<double>::infinity();
const std::string kStrip = "film: vinyl_19mm\nstrip: {length: 0.1}\n";
const std::string kArm = R"(film: vinyl_19mm
strip: {length: 0.1, position: [5, 0, 0]}
robots:
  arm: {urdf: arm7.urdf, joints: {"arm_joint[1-3]": 0.1, arm_joint4: 0.5}, drives: {kp: {"*": 100, arm_joint1: 300}, kd: 5}}
  hand: {urdf: hand20_right.urdf, position: [2, 0, 0], postures: {right_: pinch}, drives: {kp: 5}}
)";
BothWorlds read(const std::string& text) {
  const SceneFile file = SceneFile::parse(text, std::filesystem::path(TAPE_SOURCE_DIR) / "data" / "scenes" / "script.yaml");
  BothWorlds both = read_worlds(file);
  file.require_all_used();
  return both;
}
std::string refusal(const std::string& text) {
  try {
    read(text);
  } catch (const tape::InputError& e) {
    return e.what();
  }
  return "";
}
double joint(const RobotPart& part, const robot::VecX& q, const std::string& name) { return q[part.model->find_joint(name)]; }
}  // namespace

TEST(Script, WhatFollowsAWaitCountsFromWhenItEnds) {
  const BothWorlds both = read(kStrip + R"(script:
  - {grip: tape.tip, as: pull}
  - {move: pull, by: [0, 0, 0.1], speed: 0.05, wait: false}
  - {wait_until: {force: pull, above: 2}, timeout: 5}
  - {release: pull}
)");
  ASSERT_EQ(both.events.size(), 1u);
  EXPECT_EQ(both.tape.events, 1);
  EXPECT_EQ(to_text(both.events[0]), "force of pull above 2 N within 5 s");
  const tape::Grip& pull = both.tape.grips[0];
  EXPECT_EQ(pull.end.at({}), kNever);
  EXPECT_EQ(pull.end.at({1.5}), 1.5);
}
TEST(Script, AMoveStopsWhereItsEventFindsItAndTheNextGoesOnFromThere) {
  const BothWorlds both = read(kStrip + R"(script:
  - {grip: tape.tip, as: pull}
  - {move: pull, by: [0, 0, 0.1], duration: 2, until: {height: tape.tip, above: 0.03}}
  - {move: pull, by: [0.1, 0, 0], duration: 1}
)");
  const tape::Grip& pull = both.tape.grips[0];
  EXPECT_LT((grip_offset(pull, 1, {}) - tape::Vec3(0, 0, 0.05)).norm(), 1e-15);
  EXPECT_LT((grip_offset(pull, 1, {0.6}) - tape::Vec3(0.04, 0, 0.03)).norm(), 1e-15);
  EXPECT_LT((grip_offset(pull, 5, {0.6}) - tape::Vec3(0.1, 0, 0.03)).norm(), 1e-15);
  EXPECT_EQ(both.events[0].timeout, 2) << "the end of the way ends it too";
}
TEST(Script, WaitsAreRefusedWithTheirReason) {
  const auto script = [](const std::string& entry) { return kStrip + "script: [{grip: tape.tip, as: pull}, " + entry + "]"; };
  EXPECT_NE(refusal(script("{wait_until: {force: pull, above: 2}}")).find("timeout"), std::string::npos);
  EXPECT_NE(refusal(script("{wait_until: {force: push, above: 2}, timeout: 1}")).find("no grip"), std::string::npos);
  EXPECT_NE(refusal(script("{wait_until: {height: pull, above: 2}, timeout: 1}")).find("no body and no strip"), std::string::npos);
  EXPECT_NE(refusal(script("{wait_until: {force: pull}, timeout: 1}")).find("either above or below"), std::string::npos);
  EXPECT_NE(refusal(script("{wait_until: {forc: pull, above: 1}, timeout: 1}")).find("one of force, height"), std::string::npos);
  EXPECT_NE(refusal(script("{wait_until: {distance: tape, below: 1}, timeout: 1}")).find("distance"), std::string::npos);
}
TEST(Script, APhaseBeginsWhereTheEntriesAheadOfItEndAndTakesNoTime) {
  const BothWorlds both = read(kStrip + R"(script:
  - {phase: lift}
  - {grip: tape.tip, as: pull}
  - {move: pull, by: [0, 0, 0.1], duration: 2}
  - {phase: hold}
  - {wait_until: {force: pull, above: 2}, timeout: 5}
  - {wait: 0.25}
  - {phase: let_go}
  - {release: pull}
  - {phase: end, at: 8}
)");
  ASSERT_EQ(both.phases.size(), 4u);
  EXPECT_EQ(both.phases[0].name, "lift");
  EXPECT_EQ(both.phases[0].start, tape::Moment(0));
  EXPECT_EQ(both.phases[1].start, tape::Moment(2));
  EXPECT_EQ(both.phases[2].start, tape::Moment(0.25, 0)) << "a quarter of a second after the wait, whenever that ends";
  EXPECT_EQ(both.phases[3].start, tape::Moment(8));
  EXPECT_EQ(both.tape.grips[0].end, tape::Moment(0.25, 0)) << "the entry after a phase starts where it does";
}
TEST(Phases, AStepIsOfTheLastOneThatHasBegunWhenItStarts) {
  const std::vector<Phase> phases{{"a", 0.1}, {"b", {0.2, 0}}, {"c", {0, 1}}};
  const auto at = [&](double start, const std::vector<double>& events) { return phase_at(phases, start, events, 0.01); };
  EXPECT_EQ(at(0, {kNever, kNever}), -1);
  EXPECT_EQ(at(0.09, {kNever, kNever}), -1);
  EXPECT_EQ(at(0.1 - 1e-12, {kNever, kNever}), 0) << "round-off of a sum of steps";
  EXPECT_EQ(at(5, {kNever, kNever}), 0);
  EXPECT_EQ(at(0.69, {0.5, kNever}), 0);
  EXPECT_EQ(at(0.7, {0.5, kNever}), 1);
  EXPECT_EQ(at(0.7, {0.5, 0.6}), 2);
  EXPECT_EQ(phase_at({}, 1, {}, 0.01), -1);
}

TEST(Script, JointsMayBeNamedByAPattern) {
  const RobotPart arm = read(kArm).robots.robots[0];
  EXPECT_EQ(joint(arm, arm.start, "arm_joint3"), 0.1);
  EXPECT_EQ(joint(arm, arm.start, "arm_joint4"), 0.5);
  EXPECT_EQ(joint(arm, arm.start, "arm_joint5"), 0);
  EXPECT_EQ(arm.params.drives[0].kp, 300);
  EXPECT_EQ(arm.params.drives[1].kp, 100);
  EXPECT_NE(refusal(kArm + "script: [{robot: arm, joints: {arm_jont1: 1}, duration: 1}]").find("arm_joint1"), std::string::npos);
}
TEST(Script, JointsAreToldNothingBeyondTheirLimits) {
  const std::string beyond = refusal(kArm + "script: [{robot: arm, joints: {arm_joint1: 1, arm_joint2: 2.5}, duration: 2}]");
  for (const char* says : {"joints.arm_joint2 = 2.5", "[-2, 2] rad or m"}) EXPECT_NE(beyond.find(says), std::string::npos) << beyond;
  const std::string held =
      refusal("film: vinyl_19mm\nstrip: {length: 0.1}\nrobots: {arm: {urdf: arm7.urdf, drives: {kp: 1, target: {arm_joint2: -3}}}}\n");
  const auto folded = std::filesystem::temp_directory_path() / "tape_script_test_mimic.urdf";
  std::ofstream(folded) << R"(<robot name="fold"><link name="base"/>
    <link name="a"><inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>
    <link name="b"><inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>
    <joint name="lead" type="revolute"><parent link="base"/><child link="a"/><axis xyz="1 0 0"/><limit lower="-1" upper="1" effort="1" velocity="1"/></joint>
    <joint name="tip" type="revolute"><parent link="a"/><child link="b"/><axis xyz="1 0 0"/><limit lower="-1" upper="1" effort="1" velocity="1"/>
      <mimic joint="lead"/></joint></robot>)";
  const std::string follows = refusal(kStrip + "robots: {fold: {urdf: " + folded.string() +
                                      ", drives: {kp: 1}}}\nscript: [{robot: fold, joints: {tip: 0.1}, duration: 1}]");
  EXPECT_NE(follows.find("the joint follows another"), std::string::npos) << follows;
  for (const char* says : {"drives.target", "arm_joint2 = -3 (allowed: -2 to 2)"}) EXPECT_NE(held.find(says), std::string::npos) << held;
}
/// A link on a joint, and one on a joint that follows it.
std::string lead_and_tip(const std::string& lead_limits, const std::string& mimic) {
  const std::string inertial = R"(<inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1"/></inertial>)";
  const auto file = std::filesystem::temp_directory_path() / "tape_script_test_lead.urdf";
  std::ofstream(file) << R"(<robot name="fold"><link name="base"/><link name="a">)" << inertial << R"(</link><link name="b">)" << inertial
                      << R"(</link><joint name="lead" type="revolute"><parent link="base"/><child link="a"/><limit )" << lead_limits
                      << R"( effort="1" velocity="1"/></joint><joint name="tip" type="revolute"><parent link="a"/><child link="b"/>)"
                      << R"(<limit lower="-1" upper="1" effort="1" velocity="1"/><mimic joint="lead" )" << mimic << "/></joint></robot>";
  return kStrip + "robots: {fold: {urdf: " + file.string() + ", drives: {kp: 1}";
}
TEST(Script, JointsThatFollowAreToldTheirLeadersWay) {
  const RobotPart fold = read(lead_and_tip(R"(lower="-1" upper="1")", R"(multiplier="-0.5" offset="0.1")") +
                              "}}\nscript: [{robot: fold, joints: {lead: 0.4}, duration: 1}, {robot: fold, frame: b, by: [0, 0, 0]}]")
                             .robots.robots[0];
  const RobotScript script(fold, {});
  for (const double t : {0.0, 0.3, 1.0, 2.0})
    EXPECT_NEAR(joint(fold, script.told_at(t), "tip"), 0.1 - 0.5 * joint(fold, script.told_at(t), "lead"), 1e-12) << t;
  EXPECT_EQ(joint(fold, script.told_at(1), "lead"), 0.4);
}
TEST(Script, AJointThatMayNotBeAtZeroStartsAtItsNearestLimit) {
  const RobotPart fold = read(lead_and_tip(R"(lower="-0.9" upper="-0.3")", "") + ", joints: {}}}\n").robots.robots[0];
  EXPECT_EQ(joint(fold, fold.start, "lead"), -0.3);
  EXPECT_EQ(joint(fold, fold.start, "tip"), -0.3);
}
TEST(Script, WhatARobotCannotDoIsRefused) {
  const std::string fold = lead_and_tip(R"(lower="-1" upper="1")", "");
  const auto says = [](const std::string& text, const std::string& what) {
    const std::string said = refusal(text);
    EXPECT_NE(said.find(what), std::string::npos) << said;
  };
  says(fold + ", joints: {tip: 0.2}}}", "joints.tip = 0.2: the joint follows another");
  says(fold + ", velocity: [1, 0, 0]}}", "velocity = [1, 0, 0]: the base is fixed");
  says(kStrip + "robots: {hand: {urdf: hand20_right.urdf}}\nscript: [{robot: hand, posture: open, prefix: right_}]",
       "has no drive that would follow");
  says(kArm +
           "script: [{robot: arm, joints: {arm_joint1: 0.9}, duration: 1, at: 1.5}, {robot: arm, joints: {arm_joint1: 0}, duration: 1, at: "
           "0.2}]",
       "starts at 0.2 s, before the motion ahead of it in the script starts at 1.5 s");
  const auto file = std::filesystem::temp_directory_path() / "tape_script_test_way.csv";
  std::ofstream(file) << "time_s, arm_joint2 [rad]\n0, 0.9\n0.1, 0.91\n";
  says(kArm + "script: [{robot: arm, trajectory: " + file.string() + "}]",
       "joint arm_joint2 starts at 0.9 in the file, and is told to be at 0.1");
  std::ofstream(file) << "time_s, arm_joint2 [rad]\n0, 0.1\n0.1, 0.12\n";
  EXPECT_EQ(refusal(kArm + "script: [{robot: arm, trajectory: " + file.string() + "}]"), "") << "the other joints stay";
}
/// As a crease: a spring to upright, however the flap starts.
TEST(Script, DrivesHoldTheirTargetUntilAMotionSaysOtherwise) {
  const RobotPart carton =
      read(
          "film: vinyl_19mm\nstrip: {length: 0.1, position: [5, 0, 0]}\nrobots: {carton: {urdf: carton.urdf, joints: {hinge_left: 1, "
          "hinge_right: 0.5}, drives: {kp: 1, target: {hinge_left: 0.2}}}}\n"
          "script: [{wait: 1}, {robot: carton, joints: {hinge_left: 0.6}, duration: 1}]")
          .robots.robots[0];
  const RobotScript script(carton, {});
  EXPECT_EQ(joint(carton, carton.start, "hinge_left"), 1);
  EXPECT_EQ(joint(carton, script.told_at(0.5), "hinge_left"), 0.2);
  EXPECT_NEAR(joint(carton, script.told_at(1.5), "hinge_left"), 0.4, 1e-12) << "half way from the target, not from the start";
  EXPECT_EQ(joint(carton, script.told_at(2), "hinge_left"), 0.6);
  EXPECT_EQ(joint(carton, script.told_at(0.5), "hinge_right"), 0.5) << "unset: where it starts";
}
TEST(Script, AHandStartsInAPostureAndGoesToAnother) {
  const BothWorlds both = read(kArm + "script: [{robot: hand, posture: open, prefix: right_, duration: 0.4}]");
  const RobotPart& hand = both.robots.robots[1];
  EXPECT_NEAR(joint(hand, hand.start, "right_finger1_joint1"), 0.34 * 1.6, 1e-12);  // the fraction of its upper limit
  const RobotScript script(hand, {});
  EXPECT_NEAR(joint(hand, script.told_at(0.2), "right_finger1_joint1"), 0.17 * 1.6, 1e-12) << "half way, the profile is symmetric";
  EXPECT_EQ(script.told_at(0.4).cwiseAbs().maxCoeff(), 0);
}
/// Least jerk: a quarter of the time on it has come 10/64 - 15/256 + 6/1024 = 0.103516 of its way.
TEST(Script, AMotionTakesItsTimeWheneverItStarts) {
  for (const std::string start : {"0", "0.5", "3"}) {
    const RobotPart arm =
        read(kArm + "script: [{wait: " + start + "}, {robot: arm, joints: {arm_joint1: 1.1}, duration: 2}]").robots.robots[0];
    const RobotScript script(arm, {});
    const double begin = std::stod(start);
    EXPECT_EQ(joint(arm, script.told_at(begin), "arm_joint1"), 0.1) << start;
    EXPECT_NEAR(joint(arm, script.told_at(begin + 0.5), "arm_joint1"), 0.1 + 0.103515625, 1e-12) << start;
    EXPECT_NEAR(joint(arm, script.told_at(begin + 1.5), "arm_joint1"), 1.1 - 0.103515625, 1e-12) << start;
    EXPECT_EQ(joint(arm, script.told_at(begin + 2), "arm_joint1"), 1.1) << start;
  }
}
TEST(Script, AFrameMovesStraightAndAStopKeepsItWhereItIs) {
  const BothWorlds both = read(kArm + R"(script:
  - {robot: arm, frame: arm_flange, by: [0, 0, -0.05], speed: 0.05, until: {speed: tape, above: 9}}
  - {robot: arm, joints: {arm_joint1: 0.3}, duration: 1}
)");
  const RobotPart& arm = both.robots.robots[0];
  const double end = arm.motions[0].duration;
  const RobotScript never(arm, {}), stopped(arm, {end / 2});
  const robot::VecX half = never.told_at(end / 2);
  EXPECT_EQ((stopped.told_at(end / 2) - half).norm(), 0);
  EXPECT_NEAR(joint(arm, stopped.told_at(end / 2 + 1), "arm_joint1"), 0.3, 1e-12);
  EXPECT_EQ(joint(arm, stopped.told_at(end / 2 + 1), "arm_joint2"), joint(arm, half, "arm_joint2"));
  EXPECT_EQ(stopped.commands_at(end / 2)[1].velocity, 0);
  EXPECT_NE(never.told_at(end)[1], half[1]) << "nothing stops it";
}
