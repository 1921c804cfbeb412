#include "cosim/episode/replay_file.hpp"

#include <fstream>

#include "cosim/episode/episode_file.hpp"
#include "tests/cosim/episode/episodes.hpp"
using namespace cosim;
using cosim::test::expect_refused;
using cosim::test::small_episode;

namespace {
const std::string kHead = "episode: stick_19\nscene: peel_table.yaml\nrecording: e.h5\ncamera: ego\n";
const std::string kJoints = R"(joints:
  shoulder: {drives: arm:j1, unit: deg, sign: -1, offset: 0.5}
  slide: {drives: arm:rail, unit: mm}
  thumb: {drives: hand:bend, unit: 1, scale: 1.2}
max_gap: 0.3
)";

robot::Joint joint(const std::string& name, robot::JointType type, Real lower, Real upper) {
  robot::Joint j;
  j.name = name, j.type = type, j.lower = lower, j.upper = upper;
  return j;
}
/// An arm that turns and slides, and a hand whose tip follows its bend.
RobotScene arm_and_hand() {
  robot::RobotModel arm{.name = "arm"}, hand{.name = "hand"};
  arm.joints = {joint("rail", robot::JointType::prismatic, 0, 0.05), joint("j1", robot::JointType::revolute, -2, 2)};
  hand.joints = {joint("bend", robot::JointType::revolute, 0, 1.3), joint("tip", robot::JointType::revolute, 0, 3)};
  hand.joints[1].mimic = robot::Mimic{0, 2, 0.1};
  RobotScene scene;
  for (const robot::RobotModel& model : {arm, hand})
    scene.robots.push_back(
        {.name = model.name, .model = std::make_shared<const robot::RobotModel>(model), .start = robot::VecX::Constant(2, 0.01)});
  return scene;
}

class ReplayFile : public cosim::test::WithFolder {
 protected:
  ReplayFile() { write_episode(folder / "e.h5", small_episode()); }
  Replay read(const std::string& text) const { return read_replay(SceneFile::parse(text, folder / "episode.yaml")); }
  void refused(const std::string& text, std::initializer_list<std::string> says) const {
    expect_refused([&] { read(text); }, says);
  }
  void not_driven(const std::string& text, std::initializer_list<std::string> says) const {
    RobotScene robots = arm_and_hand();
    const Replay replay = read(text);
    expect_refused([&] { add_motions(replay, robots); }, says);
  }
};
std::string replaced(std::string text, const std::string& old, const std::string& by) {
  return text.replace(text.find(old), old.size(), by);
}
}  // namespace

TEST_F(ReplayFile, NamesSceneRecordingJointsAndCamera) {
  const Replay replay = read(kHead + "lead_in: 2\nstart: 0.5\nfollow: commanded\n" + kJoints);
  EXPECT_EQ(replay.name, "stick_19");
  EXPECT_EQ(replay.scene.filename(), "peel_table.yaml");
  EXPECT_EQ(replay.episode.streams.size(), 2u);
  EXPECT_EQ(replay.camera, "ego");
  EXPECT_EQ(replay.start, 0.5);
  EXPECT_EQ(replay.params.lead_in, 2);
  EXPECT_EQ(replay.params.follow, Follow::commanded);
  EXPECT_EQ(read(kHead + kJoints).params.lead_in, 3) << "the paper's";
  EXPECT_EQ(read(kHead + kJoints).start, 0);
}
TEST_F(ReplayFile, RobotsMoveAsRecordedBySignScaleUnitAndOffset) {
  RobotScene robots = arm_and_hand();
  add_motions(read(kHead + "start: 0.5\n" + kJoints), robots);
  const std::vector<robot::JointCommand> arm = RobotScript(robots.robots[0], {}).commands_at(1),
                                         hand = RobotScript(robots.robots[1], {}).commands_at(0.25);
  EXPECT_NEAR(arm[0].position, 0.025, 1e-12) << "the slide at 1.5 s: 10 + 10 t mm";
  EXPECT_NEAR(arm[1].position, 0.5 - 45 * std::numbers::pi / 180, 1e-12) << "the shoulder: 30 t deg";
  EXPECT_NEAR(hand[0].position, 1.2 * 0.375, 1e-12) << "the thumb at 0.75 s: t / 2";
  EXPECT_NEAR(robots.robots[0].start[1], 0.5 - 15 * std::numbers::pi / 180, 1e-12);
  EXPECT_NEAR(robots.robots[1].start[1], 2 * (1.2 * 0.25) + 0.1, 1e-12) << "what follows starts with what it follows";
}
TEST_F(ReplayFile, AJointMayFollowWhatItWasCommanded) {
  Episode episode = small_episode();
  for (MotionStream& stream : episode.streams) {
    stream.commanded = stream.measured;
    for (robot::VecX& row : stream.commanded) row.array() += 0.0625;
  }
  write_episode(folder / "e.h5", episode);
  RobotScene robots = arm_and_hand();
  add_motions(read(kHead + replaced(kJoints, "unit: 1, scale: 1.2", "unit: 1, scale: 1.2, follow: commanded")), robots);
  const std::vector<robot::JointCommand> arm = RobotScript(robots.robots[0], {}).commands_at(1),
                                         hand = RobotScript(robots.robots[1], {}).commands_at(0.75);
  EXPECT_NEAR(arm[0].position, 0.020, 1e-12) << "the slide as measured at 1 s: 10 + 10 t mm";
  EXPECT_NEAR(hand[0].position, 1.2 * (0.375 + 0.0625), 1e-12) << "the thumb at 0.75 s: t / 2, and 1/16 more as commanded";
  write_episode(folder / "e.h5", small_episode());
  not_driven(kHead + replaced(kJoints, "unit: 1, scale: 1.2", "unit: 1, scale: 1.2, follow: commanded"), {":8", "no commanded positions"});
}
TEST_F(ReplayFile, AJointMayDriveNothing) {
  RobotScene robots = arm_and_hand();
  add_motions(read(kHead + replaced(kJoints, "{drives: hand:bend, unit: 1, scale: 1.2}", "none")), robots);
  EXPECT_TRUE(robots.robots[1].motions.empty());
  EXPECT_EQ(robots.robots[1].start[0], 0.01);
}
TEST_F(ReplayFile, BadOnesAreRefusedByLineAndKey) {
  refused(kHead + replaced(kJoints, "thumb:", "thump:"), {":8: joints.thump", "the recording has no such joint; did you mean thumb?"});
  refused(kHead + replaced(kJoints, "  slide: {drives: arm:rail, unit: mm}\n", ""), {"joints", "recorded joint slide is missing"});
  refused(kHead + replaced(kJoints, "unit: deg", "unit: rad"), {":6: joints.shoulder.unit = rad", "is recorded in deg"});
  refused(kHead + replaced(kJoints, "unit: deg, ", ""), {"joints.shoulder.unit", "must be"});
  refused(kHead + replaced(kJoints, "sign: -1", "sign: -0.5"), {"joints.shoulder.sign = -0.5", "allowed: 1, -1"});
  refused(kHead + replaced(kJoints, ", scale: 1.2", ""), {"joints.thumb.scale", "missing"});
  refused(kHead + replaced(kJoints, "arm:rail", "arm:j1"), {":7: joints.slide.drives = arm:j1", "is driven by shoulder already"});
  refused(kHead + replaced(kJoints, "arm:rail", "rail"), {"joints.slide.drives = rail", "robot:joint"});
  refused(replaced(kHead, "camera: ego", "camera: egg") + kJoints, {":4: camera = egg", "ego, wrist_left"});
  refused(replaced(kHead, "e.h5", "f.h5") + kJoints, {":3: recording = f.h5", "no such file"});
  refused(kHead + "start: 3\n" + kJoints, {":5: start = 3", "[0, 2] s"});
  refused(kHead + "lead_inn: 3\n" + kJoints, {":5: lead_inn", "did you mean lead_in?"});
  refused(kHead, {"joints", "missing"});
}
TEST_F(ReplayFile, PhotographsAreTakenInTheOrderOfTheirNames) {
  std::filesystem::create_directory(folder / "photos");
  for (const char* name : {"2.jpg", "1.png", "notes.txt", "3.jpeg"}) std::ofstream(folder / "photos" / name) << "x";
  const Photographs photographs = read(kHead + "pictures: {folder: photos, rate: 15, first: 0.2}\n" + kJoints).photographs;
  ASSERT_EQ(photographs.files.size(), 3u);
  EXPECT_EQ(photographs.files[0].filename(), "1.png");
  EXPECT_EQ(photographs.files[2].filename(), "3.jpeg");
  EXPECT_EQ(photographs.rate, 15);
  EXPECT_EQ(photographs.first, 0.2);
  std::filesystem::create_directory(folder / "empty");
  refused(kHead + "pictures: {folder: empty}\n" + kJoints, {":5: pictures.folder = empty", "holds no photograph"});
  refused(kHead + "pictures: {folder: nowhere}\n" + kJoints, {":5: pictures.folder = nowhere", "there is no such folder"});
  refused(kHead + "pictures: {folder: photos, rate: 0}\n" + kJoints, {"pictures.rate = 0", "1/s"});
  refused(replaced(kHead, "camera: ego\n", "") + "pictures: {folder: photos}\n" + kJoints, {"pictures", "camera is missing"});
}
TEST_F(ReplayFile, ACalibrationOfAnotherResolutionIsRefused) {
  written("ego.yaml", "{fx: 600, fy: 600, cx: 424, cy: 240, width: 848, height: 480}");
  written("hd.yaml", "{fx: 900, fy: 900, cx: 640, cy: 360, width: 1280, height: 720}");
  const Replay replay = read(kHead + "calibration: ego.yaml\n" + kJoints);
  EXPECT_EQ(replay.episode.camera("ego", "").calibration.fx, 600);
  EXPECT_EQ(replay.episode.camera("ego", "").poses[0].position, small_episode().cameras[0].poses[0].position) << "its pose stays";
  refused(kHead + "calibration: hd.yaml\n" + kJoints, {":5: hd.yaml: landmarks of camera ego", "1280 x 720 px", "848 x 480 px"});
}
TEST_F(ReplayFile, AStarStandsForAnyTextAndLaterEntriesOverrideEarlierOnes) {
  const std::string shoulder = "  \"sh*er\": {drives: \"arm:j1\", unit: deg}\n", slide = "  slide: {drives: arm:rail, unit: mm}\n",
                    thumb = "  \"*umb\": {drives: \"hand:*\", unit: 1, scale: 1.2}\n", none = "  \"*\": none\n";
  const Replay replay = read(kHead + "joints:\n" + shoulder + slide + thumb);
  ASSERT_EQ(replay.joints.size(), 3u);
  EXPECT_EQ(replay.joints[0].recorded + " " + replay.joints[0].joint, "shoulder j1");
  EXPECT_EQ(replay.joints[2].recorded + " " + replay.joints[2].joint, "thumb th") << "what the star stood for";
  EXPECT_EQ(read(kHead + "joints:\n" + none + slide).joints.size(), 1u);
  refused(kHead + "joints:\n" + slide + none, {"joints.slide", "moves nothing: entries after it take all its joints"});
  refused(kHead + "joints:\n" + slide + thumb + "  \"sh*err\": none\n", {"joints.sh*err", "the recording has no such joint"});
}
TEST_F(ReplayFile, SettingsOfTheSceneMayComeWithIt) {
  EXPECT_EQ(read(kHead + "set: {time.dt: 0.005, model: coh-r}\n" + kJoints).overrides,
            (std::vector<std::string>{"time.dt=0.005", "model=coh-r"}));
}
TEST_F(ReplayFile, AScriptDoesNotMoveARobotThatTheRecordingMoves) {
  RobotScene robots = arm_and_hand();
  for (RobotPart& part : robots.robots)
    part.motions.push_back({[](const robot::VecX&) { return robot::JointTrajectory{.joints = {}, .times = {0}, .knots = {}}; }});
  add_motions(read(kHead + replaced(kJoints, "{drives: hand:bend, unit: 1, scale: 1.2}", "none")), robots);
  EXPECT_EQ(robots.robots[0].motions.size(), 1u) << "that of the recording";
  EXPECT_NEAR(RobotScript(robots.robots[0], {}).commands_at(1)[0].position, 0.02, 1e-12) << "the slide: 10 + 10 t mm";
  EXPECT_EQ(robots.robots[1].motions.size(), 1u) << "its own";
}
TEST_F(ReplayFile, MotionThatTheSceneCannotMakeIsRefused) {
  not_driven(kHead + replaced(kJoints, "arm:rail", "leg:rail"), {":7: leg:rail is of no robot of the scene"});
  not_driven(kHead + replaced(kJoints, "arm:rail", "arm:rial"), {":7: arm:rial is no joint of that robot; did you mean rail?"});
  not_driven(kHead + replaced(kJoints, "hand:bend", "hand:tip"), {":8: hand:tip follows another joint"});
  not_driven(kHead + replaced(kJoints, "scale: 1.2", "scale: 1.4"),
             {":8: thumb moves hand:bend to 1.4 at 2 s, beyond its limits", "0 to 1.3"});
  not_driven(kHead + "follow: commanded\n" + kJoints, {":9: motion hand has no commanded positions"});
  not_driven(kHead + replaced(kJoints, "max_gap: 0.3", "max_gap: 0.15"),
             {":8: motion hand: a gap from 0 s to 0.2 s (allowed: up to 0.15 s)"});
  not_driven(kHead + replaced(kJoints, "max_gap: 0.3\n", ""), {"motion hand: a gap", "up to 0.1 s"});
}
