#include "cosim/episode/resample.hpp"

#include "tests/cosim/episode/episodes.hpp"
using namespace cosim;
using cosim::test::expect_refused;
using cosim::test::small_episode;

TEST(Resample, IsLinearBetweenTheRowsAndExactInThem) {
  const MotionStream arm = small_episode().streams[0];  // shoulder 30 t deg, slide 10 + 10 t mm, commands 0.5 above
  const MotionStream at = resampled(arm, {0, 0.05, 0.1, 1.234, 2}, 0.1, "e.h5");
  ASSERT_EQ(at.measured.size(), 5u);
  for (std::size_t i = 0; i < 5; ++i) {
    EXPECT_NEAR(at.measured[i][0], 30 * at.times[i], 1e-12);
    EXPECT_NEAR(at.commanded[i][1], 10.5 + 10 * at.times[i], 1e-12);
  }
  EXPECT_EQ(at.measured[2], arm.measured[1]);
  EXPECT_EQ(at.measured[4], arm.measured[20]);
}
TEST(Resample, UnevenRowsCountByTheirTimestamps) {
  const auto row = [](Real value) { return robot::VecX::Constant(1, value); };
  const MotionStream uneven{.name = "s", .joints = {{"a"}}, .times = {0, 0.01, 0.1}, .measured = {row(0), row(1), row(10)}};
  const MotionStream at = resampled(uneven, {0.005, 0.055}, 1, "e.h5");
  EXPECT_NEAR(at.measured[0][0], 0.5, 1e-12);
  EXPECT_NEAR(at.measured[1][0], 5.5, 1e-12);
  EXPECT_TRUE(at.commanded.empty());
}
TEST(Resample, TimesThatWereNotRecordedAndGapsAreRefused) {
  MotionStream arm = small_episode().streams[0];
  expect_refused([&] { resampled(arm, {2.001}, 1, "e.h5"); }, {"e.h5: motion arm: 2.001 s is not recorded (allowed: 0 to 2 s)"});
  expect_refused([&] { resampled(arm, {-0.1}, 1, "e.h5"); }, {"-0.1 s is not recorded"});
  for (std::size_t i = 10; i < arm.times.size(); ++i) arm.times[i] += 0.3;
  expect_refused([&] { resampled(arm, {1.1}, 0.2, "e.h5"); }, {"motion arm: a gap from 0.9 s to 1.3 s (allowed: up to 0.2 s)"});
  EXPECT_NO_THROW(resampled(arm, {0.9, 1.3}, 0.2, "e.h5")) << "its borders are recorded";
  EXPECT_NO_THROW(require_no_gap(arm, 1.3, 0.2, "e.h5")) << "it lies before the start";
  expect_refused([&] { require_no_gap(arm, 1.2, 0.2, "e.h5"); }, {"a gap from 0.9 s to 1.3 s"});
}
TEST(Resample, StreamsShareTheTimesThatAllHaveRecorded) {
  Episode episode = small_episode();
  for (Real& t : episode.streams[1].times) t += 0.25;  // from 0.25 to 2.25 s
  const std::vector<Real> times = common_times(episode, 30, "e.h5");
  EXPECT_EQ(times.front(), 0.25);
  EXPECT_EQ(times.size(), 53u);  // 1.75 s at 30 Hz: 52.5 intervals
  EXPECT_NEAR(times.back(), 0.25 + 52 / 30.0, 1e-12);
  for (Real& t : episode.streams[1].times) t += 2;
  expect_refused([&] { common_times(episode, 30, "e.h5"); }, {"no time in common: one starts at 2.25 s, one ends at 2 s"});
}
