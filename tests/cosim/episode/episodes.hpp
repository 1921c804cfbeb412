#pragma once
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <numbers>
#include <string>

#include "cosim/episode/episode.hpp"
#include "tape/core/error.hpp"
#include "tape/math/rotation.hpp"

namespace cosim::test {
/// Two seconds of an arm of two joints at 10 Hz and a hand of one at 5 Hz, seen by a fixed camera and one that an arm carries.
inline Episode small_episode() {
  Episode episode{.name = "stick_19", .origin = "made for a test"};
  MotionStream arm{.name = "arm", .joints = {{"shoulder", Unit::deg}, {"slide", Unit::mm}}, .times = {}};
  for (int i = 0; i <= 20; ++i) {
    arm.times.push_back(0.1 * i);
    arm.measured.push_back(robot::VecX::Map(std::array<double, 2>{3.0 * i, 10.0 + i}.data(), 2));
    arm.commanded.push_back(arm.measured.back() + robot::VecX::Constant(2, 0.5));
  }
  MotionStream hand{.name = "hand", .joints = {{"thumb", Unit::one}}, .times = {}};
  for (int i = 0; i <= 10; ++i) {
    hand.times.push_back(0.2 * i);
    hand.measured.push_back(robot::VecX::Constant(1, 0.1 * i));
  }
  episode.streams = {arm, hand};
  EpisodeCamera ego{.name = "ego", .calibration = {.fx = 610, .lens = {-.28, .09, .0007, -.0004, -.012}}};
  ego.poses[0] = {rotation_exp({2.1, 0.3, -0.2}), {0.1, -0.4, 0.5}};
  EpisodeCamera wrist{.name = "wrist_left", .calibration = {.width = 640}, .mount = "arm:flange"};
  wrist.times = {0, 2};
  wrist.poses = {{Mat3::Identity(), {0, 0, 0.01}}, {rotation_exp({0.1, 0, 0}), {0, 0, 0.02}}};
  episode.cameras = {ego, wrist};
  episode.landmarks = {{.camera = "ego"}};
  episode.landmarks[0].landmarks = {{.time = 0.5, .pixel{400.25, 300.5}},
                                    {.time = 1.0, .pixel{410, 310}, .kind = LandmarkKind::side_box, .estimated = true},
                                    {.time = 1.5, .pixel{-900, 0}, .visible = false}};
  return episode;
}

/// That `action` is refused with an InputError whose text has all of `says`.
template <class Action>
void expect_refused(Action&& action, std::initializer_list<std::string> says) {
  try {
    action();
    ADD_FAILURE() << "accepted what should be refused with: " << *says.begin();
  } catch (const InputError& e) {
    for (const std::string& text : says) EXPECT_NE(std::string(e.what()).find(text), std::string::npos) << e.what();
  }
}

/// A folder of its own that goes with the test.
class WithFolder : public testing::Test {
 protected:
  WithFolder() { std::filesystem::create_directories(folder); }
  ~WithFolder() override { std::filesystem::remove_all(folder); }
  std::filesystem::path written(const std::string& name, const std::string& text) const {
    std::ofstream(folder / name) << text;
    return folder / name;
  }
  std::filesystem::path folder = std::filesystem::temp_directory_path() / ("episode_test_" + std::to_string(getpid()) +
                                                                           testing::UnitTest::GetInstance()->current_test_info()->name());
};
}  // namespace cosim::test
