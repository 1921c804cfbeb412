#include <gmock/gmock.h>

#include <filesystem>

#include "robot/model/inertia.hpp"
#include "robot/urdf/describe.hpp"
#include "robot/urdf/read_urdf.hpp"
#include "tests/robot/support/real_data.hpp"
using namespace robot;
using testing::IsEmpty;

namespace {
namespace fs = std::filesystem;

void expect_sound(const RobotModel& robot) {
  EXPECT_THAT(robot.notes, IsEmpty());
  for (std::size_t l = 0; l < robot.links.size(); ++l) {
    const Link& link = robot.links[l];
    EXPECT_GT(link.inertial.mass, 0) << link.name;
    for (const Shape& s : link.collision) EXPECT_GT(s.mesh.triangles.size(), 100u) << link.name;
    EXPECT_FALSE(link.collision.empty()) << link.name;
  }
}
}  // namespace

// Masses are the sums of the <mass> of the files.
TEST(RealRobots, TheMarvinArmHasSevenJoints) {
  if (!fs::exists(test::marvin_arm())) GTEST_SKIP() << "needs the Marvin arm in " << test::marvin_arm();
  const RobotModel arm = read_urdf(test::marvin_arm());
  expect_sound(arm);
  EXPECT_EQ(arm.joints.size(), 7u);
  EXPECT_NEAR(total_mass(arm), 1.2946 + 2.0407 + 1.9432 + 1.6913 + 1.5216 + 2.0099 + 0.69023365 + 0.68606212, 1e-12);
  EXPECT_EQ(arm.joints[3].lower, -2.5307);
  EXPECT_NEAR(reach(arm).bound, 0.1745 + 0.287 + 0.018 + std::hypot(0.018, 0.314), 1e-12);
}

TEST(RealRobots, TheWujiHandsHaveTwentyJointsWithRelativeAndWithPackageMeshes) {
  const fs::path folder = test::real_data() / "wuji_hand" / "urdf";
  if (!fs::exists(folder)) GTEST_SKIP() << "needs the Wuji hands in " << folder;
  for (const std::string side : {"left", "right"})
    for (const std::string kind : {"", "-ros"}) {
      const RobotModel hand = read_urdf(folder / (side + kind + ".urdf"));
      expect_sound(hand);
      EXPECT_EQ(hand.joints.size(), 20u);
      EXPECT_EQ(hand.frames.size(), 5u);
      EXPECT_NEAR(total_mass(hand), 0.16914 + (0.0075 + 0.0248 + 2 * 0.0165 + 0.0041) + 4 * (0.0032 + 0.033 + 0.0165 + 0.014 + 0.00318),
                  1e-12);
      EXPECT_EQ(hand.find_frame(side + "_finger2_tip_link")->link, hand.find_joint(side + "_finger2_joint4") + 1);
    }
}
