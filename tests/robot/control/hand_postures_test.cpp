// The postures of data/robots/hand_postures.yaml on the project's hands, by forward kinematics.
#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "robot/control/postures.hpp"
#include "robot/kinematics/forward_kinematics.hpp"
#include "tests/robot/support/own_robots.hpp"
#include "tests/robot/support/real_data.hpp"
using namespace robot;

namespace {
constexpr const char* kPostures[] = {"open", "pinch", "cup", "press"};
constexpr Real kTipRadius[] = {0.0085, 0.0075, 0.0075, 0.0075, 0.0075};  // [m] half spheres about the tip frames, thumb first

const HandPostures& postures() {
  static const HandPostures read = read_postures(TAPE_SOURCE_DIR "/data/robots/hand_postures.yaml");
  return read;
}

VecX posed(const RobotModel& hand, const std::string& prefix, const std::string& posture) {
  return test::all_joints(hand, postures().joints_of(prefix), postures().angles(hand, prefix, posture));
}

/// Poses of the five tips in the palm's frame, x out of the palm and z along its fingers.
std::vector<Pose> tips(const std::string& side, const std::string& posture) {
  const RobotModel hand = test::own_robot("hand20_" + side);
  const std::vector<Pose> X = link_poses(hand, posed(hand, side + "_", posture));
  std::vector<Pose> result;
  for (int finger = 1; finger <= 5; ++finger)
    result.push_back(frame_pose(X, *hand.find_frame(side + "_finger" + std::to_string(finger) + "_tip")));
  return result;
}
}  // namespace

TEST(HandPostures, TheFirstJointOfAFingerFlexesAndTheSecondSpreads) {
  for (const std::string side : {"left", "right"}) {
    const RobotModel hand = test::own_robot("hand20_" + side);
    for (int finger = 2; finger <= 5; ++finger) {
      const std::string name = side + "_finger" + std::to_string(finger);
      const Frame tip = *hand.find_frame(name + "_tip");
      const auto moved_by = [&](const std::string& joint) -> Vec3 {
        const VecX q = 0.2 * VecX::Unit(20, hand.find_joint(name + joint));
        return frame_pose(link_poses(hand, q), tip).translation() - frame_pose(link_poses(hand, VecX::Zero(20)), tip).translation();
      };
      EXPECT_GT(moved_by("_joint1").x(), 0.019) << name;  // out of the palm, 0.1 m of finger
      EXPECT_EQ(moved_by("_joint1").y(), 0) << name;
      EXPECT_GT(std::fabs(moved_by("_joint2").y()), 0.019) << name;
      EXPECT_EQ(moved_by("_joint2").x(), 0) << name;
    }
  }
}

TEST(HandPostures, OpenIsAFlatHand) {
  for (const std::string side : {"left", "right"}) {
    const std::vector<Pose> X = tips(side, "open");
    for (std::size_t finger = 1; finger < 5; ++finger) {
      EXPECT_NEAR(X[finger].translation().x(), -0.004, 1e-12) << side;  // as high as the knuckles
      EXPECT_TRUE(X[finger].linear().isIdentity(1e-12)) << side;
    }
  }
}

TEST(HandPostures, PinchBringsThumbAndIndexTipWithinFiveMillimetresPadToPad) {
  for (const std::string side : {"left", "right"}) {
    const std::vector<Pose> X = tips(side, "pinch");
    const Real gap = (X[0].translation() - X[1].translation()).norm() - kTipRadius[0] - kTipRadius[1];
    EXPECT_GT(gap, 0.001) << side;
    EXPECT_LT(gap, 0.005) << side;
    EXPECT_LT(X[0].linear().col(0).dot(X[1].linear().col(0)), -0.5) << side;  // the sides to which they bend face each other
    for (std::size_t finger = 2; finger < 5; ++finger) EXPECT_GT((X[finger].translation() - X[1].translation()).norm(), 0.05) << side;
  }
}

TEST(HandPostures, CupSurroundsTheRollOfItsComment) {
  constexpr Real kRadius = 0.027, kX = 0.043, kZ = 0.094;  // [m]
  for (const std::string side : {"left", "right"}) {
    const std::vector<Pose> X = tips(side, "cup");
    std::vector<Real> directions{std::numbers::pi};  // in which something is, seen from the roll's axis: the palm, and the tips
    for (std::size_t finger = 0; finger < 5; ++finger) {
      const Vec3 p = X[finger].translation();
      const Real gap = std::hypot(p.x() - kX, p.z() - kZ) - kTipRadius[finger] - kRadius;
      EXPECT_GT(gap, 0.001) << side << " " << finger + 1;
      EXPECT_LT(gap, 0.01) << side << " " << finger + 1;
      directions.push_back(std::atan2(p.z() - kZ, p.x() - kX));
    }
    std::sort(directions.begin(), directions.end());
    Real widest = directions.front() + 2 * std::numbers::pi - directions.back();
    for (std::size_t i = 1; i < directions.size(); ++i) widest = std::max(widest, directions[i] - directions[i - 1]);
    EXPECT_LT(widest, 0.85 * std::numbers::pi) << side;  // no way out: any opening is less than half a turn
  }
}

TEST(HandPostures, PressLaysTheLastLinksOfFourFingersIntoOnePlaneBeforeThePalm) {
  constexpr Real kPalm = 0.015;  // [m] its surface
  for (const std::string side : {"left", "right"}) {
    const std::vector<Pose> X = tips(side, "press");
    for (std::size_t finger = 1; finger < 5; ++finger) {
      EXPECT_NEAR(X[finger].translation().x(), X[1].translation().x(), 1e-12) << side;
      EXPECT_NEAR(X[finger].linear().col(2).x(), 0, 0.01) << side;  // along the palm
      EXPECT_GT(X[finger].translation().x() + kTipRadius[finger], kPalm + 0.01) << side;
    }
  }
}

TEST(HandPostures, TheWujiHandsTakeEachOfThemWithinTheirLimits) {
  const std::filesystem::path folder = test::real_data() / "wuji_hand" / "urdf";
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << "needs the Wuji hands in " << folder;
  for (const std::string side : {"left", "right"}) {
    const RobotModel hand = read_urdf(folder / (side + ".urdf"));
    const auto tip = [&](const std::string& posture) -> Vec3 {
      return frame_pose(link_poses(hand, posed(hand, side + "_", posture)), *hand.find_frame(side + "_finger2_tip_link")).translation();
    };
    for (const char* name : kPostures) EXPECT_EQ(postures().angles(hand, side + "_", name).size(), 20) << name;
    EXPECT_GT((tip("cup") - tip("open")).x(), 0.05) << side;  // bent in front of the palm
  }
}
