#include "cosim/episode/episode.hpp"

#include <functional>
#include <limits>

#include "tests/cosim/episode/episodes.hpp"
using namespace cosim;
using cosim::test::expect_refused;
using cosim::test::small_episode;

namespace {
constexpr Real kNan = std::numeric_limits<Real>::quiet_NaN();

void expect_unsound(const std::function<void(Episode&)>& spoil, std::initializer_list<std::string> says) {
  Episode episode = small_episode();
  spoil(episode);
  expect_refused([&] { require_sound(episode, "e.h5"); }, says);
}
}  // namespace

TEST(Episode, ASoundOneIsAcceptedWithoutRemark) {
  EXPECT_NO_THROW(require_sound(small_episode(), "e.h5"));
  EXPECT_TRUE(remarks(small_episode()).empty());
}
TEST(Episode, BadMotionIsRefusedByStreamJointAndRow) {
  expect_unsound([](Episode& e) { e.streams.clear(); }, {"e.h5: holds no motion"});
  expect_unsound([](Episode& e) { e.streams[0].times[7] = 0.3; }, {"e.h5: motion arm", "from 0.6 s to 0.3 s in row 7", "it increases"});
  expect_unsound([](Episode& e) { e.streams[0].times[7] = e.streams[0].times[6]; }, {"motion arm", "row 7"});
  expect_unsound([](Episode& e) { e.streams[1].times[3] = kNan; }, {"motion hand", "row 3", "nan"});
  expect_unsound([](Episode& e) { e.streams[0].measured[4][1] = kNan; }, {"motion arm", "joint slide measured = nan mm in row 4"});
  expect_unsound([](Episode& e) { e.streams[0].commanded[5][0] = HUGE_VAL; }, {"joint shoulder commanded = inf deg in row 5"});
  expect_unsound([](Episode& e) { e.streams[0].measured.pop_back(); }, {"20 rows measured, 21 times"});
  expect_unsound([](Episode& e) { e.streams[0].measured[2].conservativeResize(1); }, {"row 2 measured has 1 joints (allowed: 2)"});
  expect_unsound([](Episode& e) { e.streams[1].measured.clear(); }, {"motion hand", "neither measured nor commanded"});
  expect_unsound([](Episode& e) { e.streams[1].joints[0].name = "slide"; }, {"motion hand", "joint slide is there twice"});
  expect_unsound([](Episode& e) { e.streams[1].name = "arm"; }, {"motion 'arm' is there twice"});
  expect_unsound([](Episode& e) { e.streams[0].joints[0].name = ""; }, {"motion arm", "joint ''"});
}
TEST(Episode, ValuesBeyondReasonForTheirUnitAreRefused) {
  // The shoulder goes to 60 degrees, the slide to 30 mm.
  expect_unsound([](Episode& e) { e.streams[0].joints[0].unit = Unit::rad; },
                 {"joint shoulder measured = 15 rad in row 5", "12.5664", "unit"});
  expect_unsound([](Episode& e) { e.streams[0].joints[1].unit = Unit::m; }, {"joint slide measured = 11 m in row 1", "unit"});
  expect_unsound([](Episode& e) { e.streams[0].joints[0].unit = Unit::one; }, {"joint shoulder measured = 3 1 in row 1"});
}
TEST(Episode, BadCamerasAreRefusedByName) {
  expect_unsound([](Episode& e) { e.cameras[0].calibration.fx = 0; }, {"camera ego", "camera.fx = 0"});
  expect_unsound([](Episode& e) { e.cameras[0].calibration.lens.p1 = kNan; }, {"camera ego", "distortion"});
  expect_unsound([](Episode& e) { e.cameras[0].poses[0].rotation *= 1.001; }, {"camera ego", "pose 0 has no rotation"});
  expect_unsound([](Episode& e) { e.cameras[0].poses[0].rotation *= -1; }, {"camera ego", "pose 0 has no rotation"});
  expect_unsound([](Episode& e) { e.cameras[1].poses.pop_back(); }, {"camera wrist_left", "1 poses, 2 times"});
  expect_unsound([](Episode& e) { e.cameras[1].times = {2, 0}; }, {"camera wrist_left", "increases"});
  expect_unsound([](Episode& e) { e.cameras[1].name = "ego"; }, {"camera 'ego' is there twice"});
}
TEST(Episode, BadLandmarksAreRefusedByCameraAndTime) {
  expect_unsound([](Episode& e) { e.landmarks[0].landmarks[1].pixel = {848.6, 20}; }, {"camera ego", "at 1 s", "(848.6, 20)", "0 to 847"});
  expect_unsound([](Episode& e) { e.landmarks[0].landmarks[1].pixel.y() = kNan; }, {"at 1 s", "outside of the picture"});
  expect_unsound([](Episode& e) { e.landmarks[0].landmarks[1].time = 0.4; }, {"camera ego", "increases"});
  expect_unsound([](Episode& e) { e.landmarks[0].camera = "egg"; }, {"there is no camera egg (allowed: ego, wrist_left)"});
  expect_unsound([](Episode& e) { e.landmarks.push_back(e.landmarks[0]); }, {"landmarks of camera ego are there twice"});
  expect_unsound([](Episode& e) { e.landmarks[0].width = 1280, e.landmarks[0].height = 720; },
                 {"camera ego", "848 x 480 px", "1280 x 720 px"});
}
TEST(Episode, WhatIsStrangeIsRemarkedOn) {
  Episode episode = small_episode();
  for (std::size_t i = 10; i < 21; ++i) episode.streams[0].times[i] += 0.3;  // a gap of 0.4 s before 1.3 s; the arm ends later
  for (robot::VecX& row : episode.streams[0].measured) row *= 0.01;
  episode.streams[0].joints[1].unit = Unit::deg;
  episode.landmarks[0].landmarks.push_back({.time = 2.1, .pixel{10, 10}});
  const std::vector<std::string> all = remarks(episode);
  ASSERT_EQ(all.size(), 3u);
  EXPECT_EQ(all[0], "motion arm: a gap of 0.4 s before 1.3 s, where rows are usually 0.1 s apart");
  EXPECT_EQ(all[1], "motion arm: no joint goes beyond 0.6 deg; are these radians?");
  EXPECT_EQ(all[2], "landmarks of camera ego: 1 lie before 0 s or after 2 s, where a motion is not recorded");
}
TEST(Episode, UnitsCountInRadiansAndMetres) {
  EXPECT_DOUBLE_EQ(180 * si_per(Unit::deg), std::numbers::pi);
  EXPECT_EQ(si_per(Unit::mm), 1e-3);
  EXPECT_EQ(si_per(Unit::rad), 1);
}
