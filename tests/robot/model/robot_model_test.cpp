#include "robot/model/robot_model.hpp"

#include <gtest/gtest.h>
using namespace robot;

TEST(RobotModel, LinksAndFramesOfMergedLinksAreFoundByName) {
  RobotModel model;
  model.links = {{.name = "base"}, {.name = "arm"}};
  model.joints = {{.name = "shoulder"}};
  model.frames = {{"tip", 1, Pose(Eigen::Translation3d(0, 0, 0.2))}};
  EXPECT_EQ(model.find_joint("shoulder"), 0);
  EXPECT_EQ(model.find_joint("elbow"), -1);
  EXPECT_EQ(model.find_frame("arm")->link, 1);
  EXPECT_EQ(model.find_frame("tip")->X_LF.translation(), Vec3(0, 0, 0.2));
  EXPECT_FALSE(model.find_frame("hand"));
}
