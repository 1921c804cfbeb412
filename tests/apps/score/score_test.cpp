#include "apps/score/score.hpp"

#include <gtest/gtest.h>

using namespace tape;
using namespace tape::score;
using cosim::EpisodeCamera;
using cosim::LandmarkKind;
using cosim::LandmarkTrack;

namespace {
/// Looks along +z; at z = 0.5 a millimetre is 1.2 px.
const EpisodeCamera kEgo{.name = "ego", .calibration = {.fx = 600, .fy = 600, .cx = 424, .cy = 240}};
/// A hub that faces the camera; its near rim lies at z = 0.5.
Hub hub_at(Real x) { return {{Mat3::Identity(), {x, 0, 0.51}}, 0.019, 0.02}; }
/// States each 0.1 s for two seconds; the hub moves by 10 mm in each.
SimulatedHub moving() {
  SimulatedHub hub;
  for (int i = 0; i <= 20; ++i) hub.times.push_back(0.1 * i), hub.states.push_back(hub_at(0.01 * i));
  return hub;
}
/// The picture of the moving hub's rim at t [s].
Vec2 seen(Real t) { return {424 + 120 * t, 240}; }
std::vector<FrameError> frames_with_errors(std::initializer_list<std::pair<Real, Real>> time_and_error) {
  std::vector<FrameError> frames;
  for (const auto& [time, error] : time_and_error) frames.push_back({.time = time, .real{100, 100}, .simulated{100 + error, 100}});
  return frames;
}
}  // namespace

TEST(Score, TheNearestStateIsTakenAndOfTwoEquallyNearTheEarlier) {
  const std::vector<Real> times{0, 1, 2, 4};
  EXPECT_EQ(nearest(times, -5), 0u);
  EXPECT_EQ(nearest(times, 0.5), 0u);
  EXPECT_EQ(nearest(times, 0.51), 1u);
  EXPECT_EQ(nearest(times, 2), 2u);
  EXPECT_EQ(nearest(times, 3), 2u);
  EXPECT_EQ(nearest(times, 3.01), 3u);
  EXPECT_EQ(nearest(times, 9), 3u);
}
TEST(Score, AFrameIsComparedWithTheSimulatedStateAtItsTimeWithoutAnyShift) {
  // The recording runs half a second before the simulation starts; every landmark lies 3 px right of and 4 px below the simulated one.
  LandmarkTrack real{.camera = "ego", .undistorted = true};
  for (Real t : {0.1, 0.6, 1.02, 1.5}) real.landmarks.push_back({.time = t, .pixel = seen(t - 0.5) + Vec2(3, 4)});
  const std::vector<FrameError> frames = frame_errors(real, kEgo, moving(), 0.5);
  ASSERT_EQ(frames.size(), 3u) << "one lies before the start";
  EXPECT_EQ(frames[0].state, 1u);
  EXPECT_NEAR(frames[0].error(), 5, 1e-9);
  EXPECT_EQ(frames[1].state, 5u);
  EXPECT_NEAR(frames[1].time_offset, -0.02, 1e-12);
  EXPECT_NEAR(frames[1].error(), std::hypot(3 + 120 * 0.02, 4), 1e-9) << "no fit hides that the nearest state is 0.02 s earlier";
}
TEST(Score, LandmarksOfPicturesAsTheLensMakesThemAreUndistortedFirst) {
  EpisodeCamera bent = kEgo;
  bent.calibration.lens = {-.28, .09, .0007, -.0004, -.012};
  LandmarkTrack real{.camera = "ego"};
  real.landmarks = {{.time = 1, .pixel = bent.calibration.distorted(seen(1))}};
  EXPECT_LT(frame_errors(real, bent, moving(), 0)[0].error(), 1e-6);
  real.undistorted = true;
  EXPECT_GT(frame_errors(real, bent, moving(), 0)[0].error(), 1);
}
TEST(Score, EachLandmarkIsComparedWithTheSimulatedOneOfItsKindAndInvisibleOnesWithNone) {
  LandmarkTrack real{.camera = "ego", .undistorted = true};
  real.landmarks = {{.time = 1, .pixel = seen(1)},
                    {.time = 1.1, .pixel{424 + 600 * 0.11 / 0.51, 240}, .kind = LandmarkKind::side_box, .estimated = true},
                    {.time = 1.2, .visible = false}};
  const std::vector<FrameError> frames = frame_errors(real, kEgo, moving(), 0);
  ASSERT_EQ(frames.size(), 2u);
  EXPECT_LT(frames[0].error(), 1e-9);
  EXPECT_LT(frames[1].error(), 1e-9);
  EXPECT_TRUE(frames[1].estimated);
}
TEST(Score, AMovingCameraStandsWhereItWasAtTheTimeOfTheFrame) {
  EpisodeCamera camera = kEgo;
  camera.times = {0, 1};
  camera.poses = {{Mat3::Identity(), {0, 0, 0}}, {Mat3::Identity(), {0.1, 0, 0}}};
  LandmarkTrack real{.camera = "ego", .undistorted = true};
  real.landmarks = {{.time = 0.2, .pixel = seen(0.2)}, {.time = 1, .pixel = seen(0)}};
  for (const FrameError& frame : frame_errors(real, camera, moving(), 0)) EXPECT_LT(frame.error(), 1e-9);
}
TEST(Score, AWristCameraGoesWithTheLinkThatCarriesIt) {
  // The link moves along x with the hub, turned by half a turn about z; the camera is turned back on it.
  EpisodeCamera wrist = kEgo;
  wrist.mount = "arm:flange";
  Pose half_turn;
  half_turn.rotation.diagonal() = Vec3(-1, -1, 1);
  wrist.poses = {{half_turn.rotation, {-0.02, 0, 0}}};
  SimulatedHub simulated = moving();
  for (const Hub& hub : simulated.states) simulated.mounts.push_back({half_turn.rotation, {hub.X_WH.position.x() - 0.02, 0, 0}});
  LandmarkTrack real{.camera = "ego", .undistorted = true};
  real.landmarks = {{.time = 0.3, .pixel = seen(0)}, {.time = 1.7, .pixel = seen(0)}};
  for (const FrameError& frame : frame_errors(real, wrist, simulated, 0)) EXPECT_LT(frame.error(), 1e-9);
  EXPECT_THROW(frame_errors(real, wrist, moving(), 0), InputError) << "where is the link?";
  EXPECT_THROW(frame_errors(real, kEgo, simulated, 0), InputError) << "the ego camera stands in the world";
}
TEST(Score, TheMeanOfARunBeginsWithTheLeadIn) {
  EXPECT_EQ(run_score(frames_with_errors({{4.1 - 1.1, 10}, {5, 20}}), 3).frames, 2) << "4.1 - 1.1 is less than 3 by a rounding";
  const std::vector<FrameError> frames = frames_with_errors({{0, 100}, {2.99, 100}, {3, 10}, {4, 20}, {5, 60}});
  const RunScore score = run_score(frames, 3);
  EXPECT_NEAR(score.mean_error, 30, 1e-12);
  EXPECT_EQ(score.frames, 3);
  EXPECT_THROW(run_score(frames, 6), InputError);
}
TEST(Score, AFrameWithoutASimulatedLandmarkIsCountedApart) {
  std::vector<FrameError> frames = frames_with_errors({{3, 10}, {4, 20}, {5, 60}});
  frames[2].in_front = false;
  frames[1].estimated = true;
  const RunScore score = run_score(frames, 3);
  EXPECT_NEAR(score.mean_error, 15, 1e-12);
  EXPECT_EQ(score.not_in_front, 1);
  EXPECT_EQ(score.estimated, 1);
}
TEST(Score, LandmarksAfterTheLastStateAreLeftOut) {
  LandmarkTrack real{.camera = "ego", .undistorted = true};
  real.landmarks = {{.time = 1.5, .pixel = seen(1.5)}, {.time = 2.04, .pixel = seen(2)}, {.time = 2.5, .pixel = seen(2)}};
  const std::vector<FrameError> frames = frame_errors(real, kEgo, moving(), 0);
  ASSERT_EQ(frames.size(), 2u);
  EXPECT_NEAR(run_score(frames, 0).worst_time_offset, 0.04, 1e-12);
  EXPECT_THROW(run_score(frames, 0, 0.03), InputError);
  EXPECT_THROW(frame_errors(real, kEgo, {}, 0), InputError);
}
TEST(Score, RepeatsAreAveragedFirstAndEpisodesCountEqually) {
  // The means of the episodes are 20 and 40, although the first has more runs.
  const ModelScore score = model_score({"coh-r", {{10, 20, 30}, {40}}});
  EXPECT_EQ(score.episodes, std::vector<Real>({20, 40}));
  EXPECT_EQ(score.mean, 30);
  EXPECT_EQ(score.interval.low, 20);
  EXPECT_EQ(score.interval.high, 40);
  EXPECT_THROW(model_score({"coh-r", {{10}, {}}}), InputError);
}
TEST(Score, ReductionsAreThoseOfThePaper) {
  const auto of = [](Real mean) { return model_score({"", {{mean}}}); };
  EXPECT_NEAR(reduction(of(17.57), of(22.96)).share, 0.23, 0.5e-2);
  EXPECT_NEAR(reduction(of(16.28), of(22.96)).share, 0.29, 0.5e-2);
}
TEST(Score, TheIntervalOfAReductionDrawsTheEpisodesOfBothTogether) {
  // Each episode by itself is reduced by 20 %, however different the episodes are: so is every draw of them.
  const ModelScore baseline = model_score({"coh-f", {{10}, {50}, {30}}}), model = model_score({"coh-r", {{8}, {40}, {24}}});
  const Reduction found = reduction(model, baseline);
  EXPECT_NEAR(found.share, 0.2, 1e-12);
  EXPECT_NEAR(found.interval.low, 0.2, 1e-12);
  EXPECT_NEAR(found.interval.high, 0.2, 1e-12);
  EXPECT_THROW(reduction(model, model_score({"coh-f", {{10}}})), InputError);
}
TEST(Score, RepeatsAreJoinedByTheTimesOfTheirFrames) {
  std::vector<FrameError> whole = frames_with_errors({{3, 10}, {4, 20}, {5, 60}}), lacking = frames_with_errors({{4, 40}, {5, 80}});
  whole[2].in_front = false;
  whole[1].estimated = lacking[0].estimated = true;
  const std::vector<FrameMean> mean = mean_errors({whole, lacking});
  ASSERT_EQ(mean.size(), 3u);
  EXPECT_EQ(mean[0].error, 10) << "in one alone";
  EXPECT_EQ(mean[1].error, 30);
  EXPECT_TRUE(mean[1].estimated && !mean[0].estimated);
  EXPECT_EQ(mean[2].error, 80) << "not in front in the other";
  EXPECT_EQ(mean[2].time, 5);
}
