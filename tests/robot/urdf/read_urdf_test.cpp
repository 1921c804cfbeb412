#include "robot/urdf/read_urdf.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <numbers>

#include "tests/robot/urdf/robot_file.hpp"
using namespace robot;
using namespace robot::test;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

namespace {
constexpr Real kInf = std::numeric_limits<Real>::infinity();
constexpr Real kPi = std::numbers::pi;

std::vector<std::string> names(const std::vector<Link>& links) {
  std::vector<std::string> list;
  for (const Link& l : links) list.push_back(l.name);
  return list;
}
std::string box(const std::string& size, const std::string& origin = "") {
  return "<collision>" + origin + "<geometry><box size=\"" + size + "\"/></geometry></collision>";
}
const std::string kChain = link_text("a") + link_text("b") + link_text("c") + link_text("d");
}  // namespace

TEST(ReadUrdf, AJointHasTypeAxisLimitsAndDynamicsOfTheFile) {
  const RobotModel model = read_text(link_text("base", "") + link_text("arm") +
                                     joint_text("elbow", "revolute", "base", "arm",
                                                R"(<origin xyz="0.1 0.2 0.3" rpy="0 0 1.5707963267948966"/><axis xyz="0 3 4"/>
                                             <limit lower="-0.5" upper="1.5" effort="87" velocity="2.175"/>
                                             <dynamics damping="0.7" friction="0.2"/>)"));
  ASSERT_EQ(model.joints.size(), 1u);
  const Joint& j = model.joints[0];
  EXPECT_EQ(model.name, "r");
  EXPECT_EQ(j.name, "elbow");
  EXPECT_EQ(j.type, JointType::revolute);
  EXPECT_LT((j.axis - Vec3(0, 0.6, 0.8)).norm(), 1e-15);
  EXPECT_EQ(j.X_PJ.translation(), Vec3(0.1, 0.2, 0.3));
  EXPECT_LT((j.X_PJ.linear() * Vec3::UnitX() - Vec3::UnitY()).norm(), 1e-15);  // a quarter turn about z
  EXPECT_EQ(j.lower, -0.5);
  EXPECT_EQ(j.upper, 1.5);
  EXPECT_EQ(j.effort, 87);
  EXPECT_EQ(j.velocity, 2.175);
  EXPECT_EQ(j.damping, 0.7);
  EXPECT_EQ(j.friction, 0.2);
  EXPECT_FALSE(j.mimic);
  EXPECT_THAT(model.notes, IsEmpty());
}

TEST(ReadUrdf, RollPitchAndYawTurnAboutTheFixedAxesInThisOrder) {
  const RobotModel model = read_text(one_joint(R"(<origin rpy="0.3 -0.4 0.5"/>)" + kLimit));
  const Mat3 expected =
      (Eigen::AngleAxisd(0.5, Vec3::UnitZ()) * Eigen::AngleAxisd(-0.4, Vec3::UnitY()) * Eigen::AngleAxisd(0.3, Vec3::UnitX()))
          .toRotationMatrix();
  EXPECT_LT((model.joints[0].X_PJ.linear() - expected).norm(), 1e-15);
}

TEST(ReadUrdf, AContinuousJointHasNoLimitsAndAPrismaticOneItsOwn) {
  const RobotModel model =
      read_text(kChain + joint_text("spin", "continuous", "a", "b") + joint_text("slide", "prismatic", "b", "c", kLimit) +
                joint_text("turn", "continuous", "c", "d", R"(<limit lower="-1" upper="1" effort="5" velocity="6"/>)"));
  EXPECT_EQ(model.joints[0].type, JointType::continuous);
  EXPECT_EQ(model.joints[0].lower, -kInf);
  EXPECT_EQ(model.joints[0].effort, kInf);
  EXPECT_EQ(model.joints[0].axis, Vec3::UnitX());  // the axis where none is named
  EXPECT_EQ(model.joints[1].type, JointType::prismatic);
  EXPECT_EQ(model.joints[1].upper, 2);
  EXPECT_EQ(model.joints[2].upper, kInf);
  EXPECT_EQ(model.joints[2].effort, 5);
}

TEST(ReadUrdf, LinksComeDepthFirstInTheOrderOfTheFileAndJointsBeforeTheirLinks) {
  const RobotModel model = read_text(link_text("z1") + link_text("m") + link_text("a2") + link_text("base") + link_text("a1") +
                                     joint_text("to_z1", "continuous", "base", "z1") + joint_text("to_a1", "continuous", "base", "a1") +
                                     joint_text("to_m", "continuous", "z1", "m") + joint_text("to_a2", "continuous", "m", "a2"));
  EXPECT_THAT(names(model.links), ElementsAre("base", "z1", "m", "a2", "a1"));
  for (std::size_t j = 0; j < model.joints.size(); ++j) EXPECT_LT(model.joints[j].parent, static_cast<int>(j) + 1);
  EXPECT_EQ(model.joints[3].name, "to_a1");
  EXPECT_EQ(model.joints[3].parent, 0);
}

TEST(ReadUrdf, AZeroOrMissingLimitOfEffortOrVelocityIsUnlimitedAndNoted) {
  for (const std::string limit : {R"(<limit lower="-1" upper="1" effort="0" velocity="0"/>)", R"(<limit lower="-1" upper="1"/>)"}) {
    const RobotModel model = read_text(one_joint(limit));
    EXPECT_EQ(model.joints[0].effort, kInf);
    EXPECT_EQ(model.joints[0].velocity, kInf);
    EXPECT_EQ(model.joints[0].upper, 1);
    EXPECT_THAT(model.notes, ElementsAre("taken as unlimited, because they are missing or 0: effort of elbow, velocity of elbow"));
  }
}

TEST(ReadUrdf, AJointWhoseLimitsAreEqualIsNoted) {
  EXPECT_THAT(read_text(one_joint(R"(<limit lower="0" upper="0" effort="1" velocity="1"/>)")).notes,
              ElementsAre("joint elbow cannot move: lower and upper limit are 0"));
}

TEST(ReadUrdf, AMimicChainFollowsTheJointThatFollowsNone) {
  const auto mimic = [](const std::string& of, const std::string& rest) { return kLimit + "<mimic joint=\"" + of + "\" " + rest + "/>"; };
  const RobotModel model = read_text(kChain + joint_text("third", "revolute", "a", "b", mimic("second", R"(multiplier="3" offset="0.1")")) +
                                     joint_text("first", "revolute", "b", "c", kLimit) +
                                     joint_text("second", "revolute", "c", "d", mimic("first", R"(multiplier="-2" offset="0.5")")));
  EXPECT_FALSE(model.joints[1].mimic);
  ASSERT_TRUE(model.joints[0].mimic && model.joints[2].mimic);
  EXPECT_EQ(model.joints[2].mimic->joint, 1);
  EXPECT_EQ(model.joints[2].mimic->multiplier, -2);
  EXPECT_EQ(model.joints[2].mimic->offset, 0.5);
  EXPECT_EQ(model.joints[0].mimic->joint, 1);  // 3 (-2 q + 0.5) + 0.1
  EXPECT_DOUBLE_EQ(model.joints[0].mimic->multiplier, -6);
  EXPECT_DOUBLE_EQ(model.joints[0].mimic->offset, 1.6);
}

TEST(ReadUrdf, AMimicWithoutNumbersCopies) {
  const RobotModel model = read_text(link_text("a") + link_text("b") + link_text("c") + joint_text("j1", "revolute", "a", "b", kLimit) +
                                     joint_text("j2", "revolute", "b", "c", kLimit + R"(<mimic joint="j1"/>)"));
  EXPECT_EQ(model.joints[1].mimic->multiplier, 1);
  EXPECT_EQ(model.joints[1].mimic->offset, 0);
}

TEST(ReadUrdf, TheInertiaIsTurnedByItsOrigin) {
  // A quarter turn about z swaps x and y, and (x, y, z) -> (-y, x, z) takes Ixz to Iyz and Iyz to -Ixz.
  const RobotModel model =
      read_text(one_joint(kLimit, R"(<inertial><origin xyz="0.1 0.2 0.3" rpy="0 0 1.5707963267948966"/><mass value="2"/>
    <inertia ixx="0.01" ixy="0.001" ixz="0.002" iyy="0.02" iyz="0.003" izz="0.025"/></inertial>)"));
  Mat3 expected;
  expected << 0.02, -0.001, -0.003, -0.001, 0.01, 0.002, -0.003, 0.002, 0.025;
  EXPECT_LT((model.links[1].inertial.inertia - expected).norm(), 1e-16);
  EXPECT_EQ(model.links[1].inertial.com, Vec3(0.1, 0.2, 0.3));
  EXPECT_EQ(model.links[1].inertial.mass, 2);
}

TEST(ReadUrdf, OffDiagonalTermsThatAreLeftOutAreZero) {
  const RobotModel model = read_text(one_joint(kLimit, R"(<inertial><mass value="1"/><inertia ixx="1" iyy="2" izz="2.5"/></inertial>)"));
  EXPECT_EQ(model.links[1].inertial.inertia, Mat3(Vec3(1, 2, 2.5).asDiagonal()));
}

TEST(ReadUrdf, FixedLinksBecomePartOfTheirParentWithTheMassOfBoth) {
  // Two cubes of 1 kg and edge 0.1 m, 0.4 m apart along x: about the middle between them, I = 2 (m a^2 / 6) and 2 m 0.2^2 more across x.
  const RobotModel model =
      read_text(link_text("base", "") + link_text("arm", kBody + box("0.1 0.1 0.1")) +
                link_text("tool", kBody + box("0.1 0.1 0.1", R"(<origin xyz="0 0 0.05"/>)")) + link_text("tip", "") +
                joint_text("elbow", "revolute", "base", "arm", kLimit) +
                joint_text("mount", "fixed", "arm", "tool", R"(<origin xyz="0.4 0 0" rpy="0 1.5707963267948966 0"/>)") +
                joint_text("end", "fixed", "tool", "tip", R"(<origin xyz="0 0 0.1"/>)"));
  EXPECT_THAT(names(model.links), ElementsAre("base", "arm"));
  const Link& arm = model.links[1];
  EXPECT_EQ(arm.inertial.mass, 2);
  EXPECT_LT((arm.inertial.com - Vec3(0.2, 0, 0)).norm(), 1e-15);
  const Real cube = 0.00166667;
  EXPECT_LT((arm.inertial.inertia - Mat3(Vec3(2 * cube, 2 * cube + 0.08, 2 * cube + 0.08).asDiagonal())).norm(), 1e-15);
  ASSERT_EQ(arm.collision.size(), 2u);
  EXPECT_LT((arm.collision[1].X_LS.translation() - Vec3(0.45, 0, 0)).norm(), 1e-15);  // z of the tool is x of the arm
  EXPECT_EQ(model.find_frame("tool")->link, 1);
  EXPECT_LT((model.find_frame("tip")->X_LF.translation() - Vec3(0.5, 0, 0)).norm(), 1e-15);
  EXPECT_THAT(model.notes, IsEmpty());
}

TEST(ReadUrdf, AJointOnAMergedLinkStandsWhereThatLinkWas) {
  const RobotModel model =
      read_text(link_text("world", "") + link_text("foot") + link_text("arm") +
                joint_text("stand", "fixed", "world", "foot", R"(<origin xyz="0 0 1" rpy="1.5707963267948966 0 0"/>)") +
                joint_text("hip", "revolute", "foot", "arm", R"(<origin xyz="0 0 0.5"/>)" + kLimit));
  EXPECT_THAT(names(model.links), ElementsAre("world", "arm"));
  EXPECT_LT((model.joints[0].X_PJ.translation() - Vec3(0, -0.5, 1)).norm(), 1e-15);
  EXPECT_EQ(model.joints[0].parent, 0);
}

TEST(ReadUrdf, AMovingLinkWithoutInertiaIsASolidOfWaterInTheHullOfItsCollisionShapes) {
  // Two boxes side by side: a box of 0.2 x 0.1 x 0.1 m, 2 kg.
  const std::string shapes = box("0.1 0.1 0.1", R"(<origin xyz="0.05 0 0"/>)") + box("0.1 0.1 0.1", R"(<origin xyz="-0.05 0 0"/>)") +
                             R"(<visual><geometry><sphere radius="3"/></geometry></visual>)";
  const RobotModel model = read_text(one_joint(kLimit, shapes));
  const Inertial& arm = model.links[1].inertial;
  EXPECT_NEAR(arm.mass, 2, 1e-12);
  EXPECT_LT(arm.com.norm(), 1e-15);
  EXPECT_LT((arm.inertia - Mat3(Vec3(0.02, 0.05, 0.05).asDiagonal()) * 2 / 12).norm(), 1e-14);
  EXPECT_THAT(model.notes, ElementsAre("link arm has no inertia; taken is a solid of 1000 kg/m^3 in the convex hull of its collision "
                                       "shapes: 2 kg"));
}

TEST(ReadUrdf, WithoutCollisionShapesTheVisualOnesServeAsSolid) {
  const RobotModel model = read_text(one_joint(kLimit, R"(<visual><geometry><box size="0.1 0.1 0.3"/></geometry></visual>)"));
  EXPECT_NEAR(model.links[1].inertial.mass, 3, 1e-12);
  EXPECT_THAT(model.notes, ElementsAre(HasSubstr("of its visual shapes: 3 kg")));
}

TEST(ReadUrdf, AFixedPartWithoutInertiaAddsNoneAndIsNoted) {
  const RobotModel model =
      read_text(link_text("base", "") + link_text("arm") + link_text("cover", box("1 1 1")) +
                joint_text("elbow", "revolute", "base", "arm", kLimit) + joint_text("screws", "fixed", "arm", "cover"));
  EXPECT_EQ(model.links[1].inertial.mass, 1);
  EXPECT_THAT(model.notes, ElementsAre("no inertia is given for these parts of link arm; they add none: cover"));
}

TEST(ReadUrdf, AnInertiaOfZerosOnAFixedFrameIsNone) {
  const std::string zeros = R"(<inertial><mass value="0"/><inertia ixx="0" ixy="0" ixz="0" iyy="0" iyz="0" izz="0.0"/></inertial>)";
  const RobotModel model = read_text(link_text("base", zeros) + link_text("arm") + link_text("tip", zeros) +
                                     joint_text("elbow", "revolute", "base", "arm", kLimit) + joint_text("end", "fixed", "arm", "tip"));
  EXPECT_EQ(model.links[1].inertial.mass, 1);
  EXPECT_EQ(model.links[0].inertial.mass, 0);
}

TEST(ReadUrdf, ASmallViolationOfTheTriangleInequalityIsNoted) {
  const auto arm = [](const std::string& izz) {
    return R"(<inertial><mass value="1"/><inertia ixx="1" ixy="0" ixz="0" iyy="2" iyz="0" izz=")" + izz + "\"/></inertial>";
  };
  EXPECT_THAT(read_text(one_joint(kLimit, arm("2.9999"))).notes, IsEmpty());
  EXPECT_THAT(read_text(one_joint(kLimit, arm("3.0029"))).notes, ElementsAre(HasSubstr("above the sum of the others by rounding")));
  EXPECT_THAT(refusal(one_joint(kLimit, arm("3.0031"))), HasSubstr("link 'arm', inertia: principal moments = 1, 2, 3.0031 kg m^2"));
}

TEST(ReadUrdf, ShapesHaveTheirSizeOriginAndColour) {
  const RobotModel model = read_text(
      R"(<material name="red"><color rgba="1 0 0 1"/></material>)" +
      link_text("base",
                R"(<visual><origin xyz="1 2 3"/><geometry><cylinder radius="0.1" length="0.4"/></geometry><material name="red"/></visual>
              <visual><geometry><sphere radius="0.2"/></geometry><material name=""><color rgba="0 0.5 1 1"/></material></visual>)"));
  ASSERT_EQ(model.links[0].visual.size(), 2u);
  const Shape &cylinder = model.links[0].visual[0], &sphere = model.links[0].visual[1];
  EXPECT_EQ(cylinder.kind, Shape::Kind::cylinder);
  EXPECT_EQ(cylinder.size, Vec3(0.1, 0.1, 0.4));
  EXPECT_EQ(cylinder.X_LS.translation(), Vec3(1, 2, 3));
  EXPECT_EQ(cylinder.color, Vec3(1, 0, 0));
  EXPECT_EQ(sphere.size, Vec3::Constant(0.2));
  EXPECT_EQ(sphere.color, Vec3(0, 0.5, 1));
}

TEST(ReadUrdf, MaterialsThatAreUndefinedOrDefinedTwiceDoNoHarm) {
  const std::string red = R"(<material name="red"><color rgba="1 0 0 1"/></material>)";
  const RobotModel model =
      read_text(red + red + link_text("base", R"(<visual><geometry><sphere radius="1"/></geometry><material name="blue"/></visual>)"));
  EXPECT_EQ(model.links[0].visual[0].color, Shape{}.color);
  for (const char* color : {"255 0 0 1", "1 0 0", "red"}) {
    const std::string bad = std::string("<material name=\"m\"><color rgba=\"") + color + "\"/></material>";
    const std::string visual = "<visual><geometry><sphere radius=\"1\"/></geometry>";
    const RobotModel without = read_text(bad + link_text("base", visual + bad + "</visual>" + visual + "<material name=\"m\"/></visual>"));
    for (const Shape& shape : without.links[0].visual) EXPECT_EQ(shape.color, Shape{}.color) << color;
  }
}

TEST(ReadUrdf, APointMassOnAFixedJointAddsItsMass) {
  const std::string point =
      R"(<inertial><origin xyz="0 0 1"/><mass value="1"/><inertia ixx="0" ixy="0" ixz="0" iyy="0" iyz="0" izz="0"/></inertial>)";
  const RobotModel model = read_text(link_text("base") + link_text("arm") + link_text("tool", point) +
                                     joint_text("elbow", "revolute", "base", "arm", kLimit) + joint_text("end", "fixed", "arm", "tool"));
  EXPECT_EQ(model.links[1].inertial.mass, 2);
  EXPECT_NEAR(model.links[1].inertial.com.z(), 0.5, 1e-15) << "the other kilogram stands at the origin";
  EXPECT_THAT(refusal(one_joint(kLimit, point)), HasSubstr("link 'arm', inertia: principal moments = 0, 0, 0"));
}

TEST(ReadUrdf, AnAxisWithoutNumbersIsXAndAnInfiniteLimitIsNone) {
  const RobotModel model =
      read_text(link_text("a") + link_text("b") +
                joint_text("j", "revolute", "a", "b", R"(<axis/><limit lower="-1" upper="1" effort="inf" velocity="inf"/>)"));
  EXPECT_EQ(model.joints[0].axis, Vec3::UnitX());
  EXPECT_EQ(model.joints[0].effort, kInf);
  EXPECT_EQ(model.joints[0].velocity, kInf);
}

TEST(ReadUrdf, AJointThatItsFollowersHoldBackIsNoted) {
  const auto with = [](const std::string& mimic) {
    return read_text(link_text("a") + link_text("b") + link_text("c") +
                     joint_text("lead", "revolute", "a", "b", R"(<limit lower="0" upper="0.8" effort="1" velocity="1"/>)") +
                     joint_text("tip", "revolute", "b", "c", R"(<limit lower="0" upper="0.4" effort="1" velocity="1"/>)" + mimic));
  };
  EXPECT_THAT(with(R"(<mimic joint="lead" multiplier="0.5"/>)").notes, IsEmpty());
  EXPECT_THAT(with(R"(<mimic joint="lead"/>)").notes, ElementsAre(HasSubstr("joint lead has only 0 to 0.4 of its 0 to 0.8")));
  EXPECT_THAT(with(R"(<mimic joint="lead" multiplier="-1"/>)").notes, ElementsAre(HasSubstr("it cannot move")));
}

TEST(ReadUrdf, NeighboursAndWhatTheSrdfFileNamesMayOverlap) {
  const std::string robot = kChain + link_text("tip", "") + joint_text("j1", "continuous", "a", "b") +
                            joint_text("j2", "continuous", "b", "c") + joint_text("j3", "continuous", "c", "d") +
                            joint_text("end", "fixed", "d", "tip");
  const std::string srdf = R"(<?xml version="1.0"?><robot name="r"><group name="g"/>
    <disable_collisions link1="tip" link2="a" reason="Never"/>
    <disable_collisions link1="tip" link2="d" reason="Adjacent"/>
    <disable_collisions link1="ghost" link2="a"/></robot>)";
  const Folder folder;
  UrdfOptions options{.srdf = folder.write("other.srdf", srdf)};
  const fs::path urdf = folder.write("r.urdf", robot_text(robot));
  using Pairs = std::vector<std::pair<int, int>>;
  EXPECT_EQ(read_urdf(urdf).may_overlap, (Pairs{{0, 1}, {1, 2}, {2, 3}}));
  const RobotModel model = read_urdf(urdf, options);
  EXPECT_EQ(model.may_overlap, (Pairs{{0, 1}, {0, 3}, {1, 2}, {2, 3}}));
  EXPECT_THAT(model.notes, Contains("the SRDF file names links that the robot does not have: ghost"));
  options.srdf = folder.write("two.srdf", R"(<robot name="r"><disable_default_collisions link="d"/>
    <enable_collisions link1="b" link2="d"/></robot>)");
  EXPECT_EQ(read_urdf(urdf, options).may_overlap, (Pairs{{0, 1}, {0, 3}, {1, 2}, {2, 3}})) << "d with all but b";
  folder.write("r.srdf", srdf);  // beside the URDF file
  EXPECT_EQ(read_urdf(urdf).may_overlap, model.may_overlap);
}

TEST(ReadUrdf, TagsOfOtherProgramsCommentsAndDosLineEndsAreOfNoConsequence) {
  std::string text =
      "<?xml version=\"1.0\" encoding=\"utf-8\"?>\r\n<!-- made by an exporter -->\r\n<robot name=\"r\" "
      "xmlns:xacro=\"http://www.ros.org/wiki/xacro\">\r\n<mujoco><compiler meshdir=\"../meshes/${side}\"/></mujoco>\r\n"
      "<gazebo reference=\"arm\"><kp>1</kp></gazebo>\r\n<transmission name=\"t\"><joint name=\"elbow\"/></transmission>\r\n";
  text += link_text("base", "") + "<!-- <link name=\"base\"/> -->\r\n" + link_text("arm") +
          joint_text("elbow", "revolute", "base", "arm", "<origin\r\n xyz=\" 1\t2\r\n +3 \" rpy=\"0  0 0\"/>" + kLimit) + "</robot>\r\n";
  const Folder folder;
  for (const std::string start : {"", "\xEF\xBB\xBF"}) {  // a byte order mark
    const RobotModel model = read_urdf(folder.write("dos.urdf", start + text));
    EXPECT_EQ(model.joints.at(0).X_PJ.translation(), Vec3(1, 2, 3));
  }
}

TEST(ReadUrdf, FixedJointsMayCarryWhatExportersWriteThere) {
  const RobotModel model = read_text(
      link_text("a") + link_text("b") +
      joint_text("j", "fixed", "a", "b", R"(<axis xyz="0 0 0"/><limit lower="0" upper="0" effort="0" velocity="0"/><mimic joint="x"/>)"));
  EXPECT_EQ(model.links.size(), 1u);
  EXPECT_EQ(model.links[0].inertial.mass, 2);
}

TEST(ReadUrdf, QuarterTurnsOfFewDigitsStayRotations) {
  const RobotModel model = read_text(one_joint(R"(<origin rpy="1.5708 -1.5708 3.1416"/>)" + kLimit));
  const Mat3 R = model.joints[0].X_PJ.linear();
  EXPECT_LT((R * R.transpose() - Mat3::Identity()).norm(), 1e-15);
  EXPECT_LT(
      (R - (Eigen::AngleAxisd(kPi, Vec3::UnitZ()) * Eigen::AngleAxisd(-kPi / 2, Vec3::UnitY()) * Eigen::AngleAxisd(kPi / 2, Vec3::UnitX()))
               .toRotationMatrix())
          .norm(),
      4e-5);
}
