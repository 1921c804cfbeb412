#include <gmock/gmock.h>

#include "tests/robot/urdf/robot_file.hpp"
using namespace robot;
using namespace robot::test;
using testing::AllOf;
using testing::HasSubstr;
using testing::MatchesRegex;

namespace {
std::string body(const std::string& mass, const std::string& ixx, const std::string& iyy = "1", const std::string& ixy = "0") {
  return "<inertial><mass value=\"" + mass + "\"/><inertia ixx=\"" + ixx + "\" ixy=\"" + ixy + "\" ixz=\"0\" iyy=\"" + iyy +
         "\" iyz=\"0\" izz=\"1\"/></inertial>";
}
std::string limit(const std::string& lower, const std::string& upper, const std::string& effort = "1", const std::string& velocity = "1") {
  return "<limit lower=\"" + lower + "\" upper=\"" + upper + "\" effort=\"" + effort + "\" velocity=\"" + velocity + "\"/>";
}
const std::string kThree = link_text("a") + link_text("b") + link_text("c");
}  // namespace

TEST(BadUrdf, EveryRefusalNamesFileLineElementValueAndWhatIsAllowed) {
  EXPECT_THAT(refusal(one_joint("\n" + limit("-1", "1", "-3"))),
              MatchesRegex(".*/r.urdf:6: joint 'elbow', limit: effort = \"-3\": allowed is >= 0"));
}

TEST(BadUrdf, LimitsOutOfRangeAreRefused) {
  EXPECT_THAT(refusal(one_joint(limit("2", "1"))), HasSubstr("joint 'elbow', limit: lower = 2 is above upper = 1"));
  EXPECT_THAT(refusal(one_joint(limit("nan", "1"))), HasSubstr("lower = \"nan\": allowed is a finite number"));
  EXPECT_THAT(refusal(one_joint(limit("-1", "inf"))), HasSubstr("upper = \"inf\": allowed is a finite number"));
  EXPECT_THAT(refusal(one_joint(limit("-1", "1", "1", "-2"))), HasSubstr("velocity = \"-2\": allowed is >= 0"));
  EXPECT_THAT(refusal(one_joint(limit("-1", "1,5"))), HasSubstr("upper = \"1,5\""));
  EXPECT_THAT(refusal(one_joint("")), HasSubstr("joint 'elbow': a revolute joint needs a <limit>"));
  EXPECT_THAT(refusal(link_text("a") + link_text("b") + joint_text("rail", "prismatic", "a", "b")),
              HasSubstr("joint 'rail': a prismatic joint needs"));
  EXPECT_THAT(refusal(one_joint(limit("-1", "1") + R"(<dynamics damping="-0.1"/>)")), HasSubstr("dynamics: damping = \"-0.1\""));
}

TEST(BadUrdf, MassesAndInertiasOfNoBodyAreRefused) {
  EXPECT_THAT(refusal(one_joint(kLimit, body("0", "1"))), HasSubstr("link 'arm', mass: value = \"0\": allowed is > 0"));
  EXPECT_THAT(refusal(one_joint(kLimit, body("-2", "1"))), HasSubstr("value = \"-2\": allowed is > 0"));
  EXPECT_THAT(refusal(one_joint(kLimit, body("1", "0"))), AllOf(HasSubstr("link 'arm', inertia"), HasSubstr("allowed is > 0 each")));
  EXPECT_THAT(refusal(one_joint(kLimit, body("1", "-1"))), HasSubstr("allowed is > 0 each"));
  EXPECT_THAT(refusal(one_joint(kLimit, body("1", "1", "1", "1.1"))), HasSubstr("allowed is > 0 each"));  // the off-diagonal term does it
  EXPECT_THAT(refusal(one_joint(kLimit, body("1", "1", "2.1"))), HasSubstr("none above the sum of the two others"));
  EXPECT_THAT(refusal(one_joint(kLimit, body("1", "1e400"))), HasSubstr("ixx = \"1e400\""));
  EXPECT_THAT(refusal(one_joint(kLimit, "")), HasSubstr("link 'arm' moves, but has neither an inertia nor a shape"));
  EXPECT_THAT(refusal(one_joint(kLimit, R"(<inertial><mass value="1"/></inertial>)")), HasSubstr("no valid URDF"));
}

TEST(BadUrdf, WhatIsNotReadIsNoted) {
  const RobotModel model = read_text(one_joint(R"(<axs xyz="0 0 1"/><limit lower="-1" upper="1" efort="3" effort="1" velocity="1"/>)"));
  EXPECT_THAT(model.notes, testing::ElementsAre("not read: <axs> of <joint>, in elbow", "not read: attribute efort of <limit>, in elbow"));
  EXPECT_THAT(refusal(one_joint(R"(<origin xyz="0 0 1e300"/>)" + limit("-1", "1"))),
              HasSubstr("xyz = \"0 0 1e300\": allowed is 3 numbers, each -10000 to 10000"));
}

TEST(BadUrdf, ATreeIsAsked) {
  EXPECT_EQ(read_text(link_text("base, left") + link_text("b") + joint_text("j", "continuous", "base, left", "b")).joints.size(), 1u);
  EXPECT_THAT(refusal(kThree + joint_text("j", "fixed", "a", "b")), HasSubstr("more than one root: links 'a', 'c' hang on no joint"));
  EXPECT_THAT(
      refusal(kThree + joint_text("j1", "fixed", "a", "b") + joint_text("j2", "fixed", "b", "c") + joint_text("j3", "fixed", "c", "a")),
      HasSubstr("closes a loop"));
  EXPECT_THAT(refusal(kThree + link_text("d") + joint_text("j1", "fixed", "a", "b") + joint_text("j2", "fixed", "c", "d") +
                      joint_text("j3", "fixed", "d", "c")),
              HasSubstr("closes a loop through link"));
  EXPECT_THAT(refusal(link_text("a") + joint_text("j", "fixed", "a", "a")), HasSubstr("closes a loop through link 'a'"));
  EXPECT_THAT(refusal(kThree + joint_text("j1", "fixed", "a", "c") + joint_text("j2", "fixed", "b", "c")),
              HasSubstr("joint 'j2': its child 'c' hangs on joint 'j1' already"));
  EXPECT_THAT(refusal(""), HasSubstr("the robot has no link"));
}

TEST(BadUrdf, NamesThatAreMissingUnknownOrTakenAreRefused) {
  EXPECT_THAT(refusal(link_text("a") + link_text("a")), MatchesRegex(".*:4: link 'a': the name is taken by the link in line 3"));
  EXPECT_THAT(refusal(kThree + joint_text("j", "fixed", "a", "b") + joint_text("j", "fixed", "b", "c")),
              HasSubstr("taken by the joint in line 6"));
  EXPECT_THAT(refusal(kThree + joint_text("j", "fixed", "a", "ghost")),
              HasSubstr("joint 'j': its child is \"ghost\": there is no such link"));
  EXPECT_THAT(refusal(kThree + joint_text("j", "fixed", "ghost", "a")), HasSubstr("joint 'j': its parent is \"ghost\""));
  EXPECT_THAT(refusal("<link/>"), HasSubstr("it has no name"));
}

TEST(BadUrdf, JointsThatThisModelHasNotAreRefused) {
  for (const std::string type : {"floating", "planar", "Revolute", ""})
    EXPECT_THAT(refusal(link_text("a") + link_text("b") + joint_text("j", type, "a", "b")),
                HasSubstr("joint 'j': type = \"" + type + "\": allowed is fixed, revolute, continuous, prismatic"));
  EXPECT_THAT(refusal(link_text("a") + link_text("b") + joint_text("j", "continuous", "a", "b", R"(<axis xyz="0 0.0 -0"/>)")),
              HasSubstr("joint 'j', axis: xyz = \"0 0 0\""));
  EXPECT_THAT(refusal(link_text("a") + link_text("b") + joint_text("j", "continuous", "a", "b", R"(<axis xyz="0 1"/>)")),
              HasSubstr("xyz = \"0 1\": allowed is 3 numbers"));
}

TEST(BadUrdf, MimicsOfNothingAndOfThemselvesAreRefused) {
  const auto two = [](const std::string& first, const std::string& second) {
    return kThree + joint_text("j1", "revolute", "a", "b", kLimit + first) + joint_text("j2", "revolute", "b", "c", kLimit + second);
  };
  const std::string of_1 = R"(<mimic joint="j1"/>)", of_2 = R"(<mimic joint="j2"/>)";
  EXPECT_THAT(refusal(two(of_2, of_1)), HasSubstr("joint 'j1', mimic: it follows itself, through joint 'j1'"));
  EXPECT_THAT(refusal(two(of_1, "")), HasSubstr("it follows itself"));
  EXPECT_THAT(refusal(two("", R"(<mimic joint="ghost"/>)")), HasSubstr("joint 'j2', mimic: joint = \"ghost\""));
  EXPECT_THAT(
      refusal(kThree + joint_text("f", "fixed", "a", "b") + joint_text("j", "revolute", "b", "c", kLimit + R"(<mimic joint="f"/>)")),
      HasSubstr("allowed is the name of a joint that moves"));
}

TEST(BadUrdf, ShapesOfNoSizeAreRefused) {
  const auto shape = [](const std::string& geometry) {
    return link_text("a", "<collision><geometry>" + geometry + "</geometry></collision>");
  };
  EXPECT_THAT(refusal(shape(R"(<box size="1 0 1"/>)")), HasSubstr("link 'a', box: size = \"1 0 1\": allowed is 3 numbers, each > 0"));
  EXPECT_THAT(refusal(shape(R"(<sphere radius="-1"/>)")), HasSubstr("sphere: radius"));
  EXPECT_THAT(refusal(shape(R"(<cylinder radius="1" length="0"/>)")), HasSubstr("cylinder: length"));
  EXPECT_THAT(refusal(shape(R"(<mesh filename="m.stl" scale="1 0 1"/>)")), HasSubstr("mesh: scale"));
  EXPECT_THAT(refusal(shape(R"(<blob/>)")), HasSubstr("blob"));
  EXPECT_THAT(refusal(shape("")), HasSubstr("no valid URDF"));
}

TEST(BadUrdf, WhatXacroLeftIsRefused) {
  EXPECT_THAT(refusal(one_joint(limit("${lower}", "1"))), HasSubstr("joint 'elbow', limit: lower = \"${lower}\" is left from xacro"));
  EXPECT_THAT(refusal(link_text("${prefix}base")), HasSubstr("is left from xacro"));
  EXPECT_THAT(refusal(link_text("a", R"(<visual><geometry><mesh filename="$(find p)/a.stl"/></geometry></visual>)")),
              HasSubstr("from xacro"));
  EXPECT_THAT(refusal("<xacro:arm/>" + link_text("a")), HasSubstr("<xacro:arm> is a xacro macro"));
}

TEST(BadUrdf, WhatIsNoUrdfIsRefused) {
  const Folder folder;
  const auto said = [](const fs::path& file) {
    try {
      read_urdf(file);
    } catch (const InputError& e) {
      return std::string(e.what());
    }
    return std::string("accepted");
  };
  EXPECT_THAT(said(folder.path() / "none.urdf"), HasSubstr("none.urdf: there is no such file"));
  EXPECT_THAT(said(folder.path()), HasSubstr(folder.path().string()));
  EXPECT_THAT(said(folder.write("a.urdf", "")), HasSubstr("a.urdf"));
  EXPECT_THAT(said(folder.write("b.urdf", "<robot name='r'>\n<link name='a'>\n</robot>")), HasSubstr("b.urdf:2: not well-formed XML"));
  EXPECT_THAT(said(folder.write("c.urdf", "<sdf/>")), HasSubstr("no element <robot>"));
  EXPECT_THAT(said(folder.write("d.urdf", "<robot><link name='a'/></robot>")), HasSubstr("d.urdf: no valid URDF"));
  const fs::path good = folder.write("e.urdf", robot_text(link_text("a")));
  EXPECT_THROW(read_urdf(good, {.srdf = folder.path() / "none.srdf"}), InputError);
  EXPECT_THROW(read_urdf(good, {.srdf = folder.write("f.srdf", "<robot><disable_collisions link1='a'/></robot>")}), InputError);
  EXPECT_THROW(read_urdf(good, {.srdf = folder.write("g.srdf", "<robots/>")}), InputError);
}
