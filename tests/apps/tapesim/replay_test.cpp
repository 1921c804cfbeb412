#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <csignal>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <numbers>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <sstream>

#include "apps/render/picture.hpp"
#include "cosim/episode/episode_file.hpp"
#include "cosim/run/state_file.hpp"
#include "tests/apps/tapesim/program.hpp"
#include "tests/robot/support/real_data.hpp"

using namespace tape::test;
using cosim::Episode;
using cosim::Landmark;
using testing::AllOf;
using testing::HasSubstr;

namespace {
/// A tray that slides along x.
constexpr const char* kTray = R"(<robot name="tray">
  <link name="rail"/>
  <link name="tray">
    <inertial><mass value="1"/><inertia ixx="0.002" iyy="0.002" izz="0.004" ixy="0" ixz="0" iyz="0"/></inertial>
    <collision><geometry><box size="0.12 0.12 0.01"/></geometry></collision>
  </link>
  <joint name="slide" type="prismatic">
    <parent link="rail"/><child link="tray"/><axis xyz="1 0 0"/><limit lower="-0.2" upper="0.2" effort="1000" velocity="2"/>
  </joint>
</robot>
)";
/// A ring stands on the tray, which carries it 50 mm along x under a camera that looks down from 0.4 m above the ring's upper rim: a
/// millimetre is 1.5 px.
constexpr const char* kScene = R"(scene: tray
time: {dt: 0.01, duration: 0.8}
bodies:
  hub: {shape: ring, inner_radius: 0.019, outer_radius: 0.0211, height: 0.02, segments: 24, motion: dynamic, density: 950, position: [0, 0, 0.0155]}
robots:
  tray: {urdf: tray.urdf, drives: {kp: 2.0e+4, kd: 400}}
script:
  - {wait: 0.1}
  - {robot: tray, joints: {slide: 0.05}, duration: 0.5}
camera:
  - {name: ego, fx: 600, fy: 600, cx: 423.5, cy: 239.5, width: 848, height: 480, distortion: [-0.28, 0.09, 0.0007, -0.0004, -0.012],
     position: [0.02, 0.01, 0.4255], rotation: [3.14159265358979, 0, 0]}
  - {name: wrist, fx: 600, fy: 600, cx: 423.5, cy: 239.5, width: 848, height: 480, mount: "tray:tray", position: [0, 0, 0.4255],
     rotation: [3.14159265358979, 0, 0]}
)";

using tape::render::Picture;
Picture picture(const std::string& file) {
  cv::Mat read = cv::imread(file);
  Picture picture(read.cols, read.rows);
  cv::cvtColor(read, cv::Mat(read.rows, read.cols, CV_8UC3, picture.rgb.data()), cv::COLOR_BGR2RGB);
  return picture;
}

/// The cells of a column of a CSV file whose header has it.
std::vector<std::string> column(const std::filesystem::path& file, const std::string& name) {
  std::istringstream lines(read(file));
  std::vector<std::string> cells;
  int wanted = -1;
  for (std::string line; std::getline(lines, line);) {
    std::istringstream row(line);
    int k = 0;
    for (std::string cell; std::getline(row, cell, ','); ++k) {
      if (wanted < 0 && cells.empty() && cell == name)
        wanted = k;
      else if (k == wanted)
        cells.push_back(cell);
    }
  }
  return cells;
}

class ReplayCommand : public testing::Test {
 protected:
  /// Once for all tests: the scene is simulated and recorded as rec.h5 and rec.yaml; the recording is replayed without drives and becomes
  /// an episode again, real.h5 and real.yaml: as far as a posed replay can tell, that is how the world was.
  static void SetUpTestSuite() {
    folder = std::make_unique<Folder>();
    folder->file("tray.urdf", kTray);
    const std::string scene = folder->file("tray.yaml", kScene);
    const Outcome made = tapesim({"run", scene, "--out", at("made"), "--record", at("rec.h5")});
    ASSERT_EQ(made.exit_code, 0) << made.err;
    start_counting("rec");
    const Outcome posed = replay("rec", {"--set", "exchange.schedule=posed", "--record", at("real.h5")});
    ASSERT_EQ(posed.exit_code, 0) << posed.err;
    start_counting("real");
    variant_of_text("real", "set:\n  exchange.schedule: \"posed\"\n", "");  // what it was recorded with; each test says what it wants
  }
  static void TearDownTestSuite() { folder.reset(); }
  static std::string at(const std::string& name) { return (*folder / name).string(); }

  /// At 0.1 s: a recording shorter than the lead-in that is excluded by default has none.
  static void start_counting(const std::string& episode) { variant_of_text(episode, "lead_in: 0\n", "lead_in: 0.1\n"); }
  /// In EPISODE.yaml itself.
  static void variant_of_text(const std::string& episode, const std::string& from, const std::string& to) {
    std::string text = read(at(episode + ".yaml"));
    ASSERT_NE(text.find(from), std::string::npos) << text;
    folder->file(episode + ".yaml", text.replace(text.find(from), from.size(), to));
  }
  static Outcome replay(const std::string& episode, const std::vector<std::string>& more = {}) {
    std::vector<std::string> arguments{"replay", at(episode + ".yaml"), "--out", at("out_" + episode)};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return tapesim(arguments);
  }
  /// [px] of the first model.
  static double mean_error(const std::string& episode) { return std::stod(column(at("out_" + episode + "/replay.csv"), "mean_px").at(0)); }

  /// [rad or m] of a joint of the one robot at the end of the only run.
  static double last_position(const std::string& episode, int joint) {
    const cosim::StateReader states(at("out_" + episode + "/" + episode + "/none/1/state.h5"));
    return states.frame(states.frames() - 1).robots.at(0).position[joint];
  }

  /// NAME.h5 and NAME.yaml: real.h5 after a change, with other text in the YAML file.
  template <class Change>
  static void variant(const std::string& name, Change&& change, const std::vector<std::pair<std::string, std::string>>& texts = {}) {
    Episode episode = cosim::read_episode(at("real.h5"));
    change(episode);
    cosim::write_episode(at(name + ".h5"), episode);
    variant_text(name, texts);
  }
  static void variant_text(const std::string& name, const std::vector<std::pair<std::string, std::string>>& texts) {
    std::string text = read(at("real.yaml"));
    const auto replace = [&](const std::string& from, const std::string& to) {
      const std::size_t place = text.find(from);
      ASSERT_NE(place, std::string::npos) << from;
      text.replace(place, from.size(), to);
    };
    replace("recording: real.h5", "recording: " + name + ".h5");
    replace("episode: real", "episode: " + name);
    for (const auto& [from, to] : texts) replace(from, to);
    folder->file(name + ".yaml", text);
  }
  static const std::vector<std::string> kPosed;
  static std::unique_ptr<Folder> folder;
};
std::unique_ptr<Folder> ReplayCommand::folder;
const std::vector<std::string> ReplayCommand::kPosed = {"--set", "exchange.schedule=posed"};

void nothing(Episode&) {}
}  // namespace

TEST_F(ReplayCommand, ARecordingHoldsTheMotionAndWhatEveryCalibratedCameraSees) {
  const Episode episode = cosim::read_episode(at("rec.h5"));
  EXPECT_TRUE(episode.synthetic());
  EXPECT_THAT(episode.origin, HasSubstr("tray.yaml"));
  ASSERT_EQ(episode.streams.size(), 1u);
  EXPECT_EQ(episode.streams[0].joints[0].name, "tray:slide");
  EXPECT_EQ(episode.streams[0].joints[0].unit, cosim::Unit::m);
  EXPECT_EQ(episode.streams[0].times.size(), 81u) << "100 a second, start and end";
  EXPECT_NEAR(episode.streams[0].commanded.back()[0], 0.05, 1e-9);
  EXPECT_NEAR(episode.streams[0].measured.back()[0], 0.05, 1e-4);
  ASSERT_EQ(episode.landmarks.size(), 2u);
  const cosim::LandmarkTrack& ego = episode.landmarks[0];
  ASSERT_EQ(ego.landmarks.size(), 25u) << "30 a second, start and end";
  for (const Landmark& mark : ego.landmarks) EXPECT_TRUE(mark.visible && !mark.estimated && mark.kind == cosim::LandmarkKind::rim);
  // The rim's centre, seen straight from above: no bias of the ellipse. It starts 20 mm left of and 10 mm above the camera's middle, as the
  // camera's y looks to -y. The ring may sink by 0.5 mm of the 0.4 m.
  const cosim::Calibration& lens = episode.cameras[0].calibration;
  const tape::Vec2 first = lens.undistorted(ego.landmarks.front().pixel), last = lens.undistorted(ego.landmarks.back().pixel);
  EXPECT_NEAR(first.x(), 423.5 - 600 * 0.02 / 0.4, 0.1);
  EXPECT_NEAR(first.y(), 239.5 + 600 * 0.01 / 0.4, 0.1);
  EXPECT_NEAR(last.x(), 423.5 + 600 * 0.03 / 0.4, 0.3);
  EXPECT_GT((first - ego.landmarks.front().pixel).norm(), 0.01) << "as the lens makes them";
  for (const Landmark& mark : episode.landmarks[1].landmarks)
    EXPECT_NEAR(mark.pixel.x(), 423.5, 1) << "the wrist camera goes with the tray";
}
TEST_F(ReplayCommand, AReplayAgainstItselfScoresNothing) {
  const Outcome outcome = replay("real", kPosed);
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_LT(mean_error("real"), 0.05);
  EXPECT_THAT(outcome.out, AllOf(HasSubstr("synthetic"), HasSubstr("from 0.1 s on")));
  EXPECT_THAT(folder->names("out_real"), testing::IsSupersetOf({"frames.csv", "replay.csv", "runs.csv", "runs.json"}));
  EXPECT_THAT(folder->names("out_real/real/none/1"),
              testing::ElementsAre("errors.csv", "report.json", "snapshot.h5", "state.h5", "steps.csv"));
  const auto report = nlohmann::json::parse(read(at("out_real/real/none/1/report.json")));
  EXPECT_NEAR(report["figures"]["mean_error_px"], mean_error("real"), 1e-12);
  EXPECT_EQ(column(at("out_real/frames.csv"), "data").at(0), "synthetic");
}
TEST_F(ReplayCommand, DrivesThatAreToldTheSameMoveTheSame) {
  variant_text("told", {{"recording: told.h5", "recording: rec.h5"}, {"camera: ego", "camera: ego\nfollow: commanded"}});
  ASSERT_EQ(replay("told", {"--record", at("again.h5")}).exit_code, 0);
  variant_text("again", {{"camera: ego", "camera: ego\nfollow: commanded"}});
  const Outcome outcome = replay("again");
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_LT(mean_error("again"), 0.05);
}
TEST_F(ReplayCommand, ACameraThatStandsOnePixelOffScoresOnePixel) {
  variant("shifted", [](Episode& e) { e.cameras[0].calibration.cx += 1; });
  ASSERT_EQ(replay("shifted", kPosed).exit_code, 0);
  // The landmarks stay: what is simulated moves by 1 px, and what is undistorted about a middle that is 1 px off by some hundredths.
  EXPECT_NEAR(mean_error("shifted"), 1, 0.05);
  variant("shifted_marks", [](Episode& e) {
    for (Landmark& mark : e.landmarks[0].landmarks) {
      const cosim::Calibration& lens = e.cameras[0].calibration;
      mark.pixel = lens.distorted(lens.undistorted(mark.pixel) + tape::Vec2(0, 1));
    }
  });
  ASSERT_EQ(replay("shifted_marks", kPosed).exit_code, 0);
  EXPECT_NEAR(mean_error("shifted_marks"), 1, 0.01);
}
TEST_F(ReplayCommand, AnOffsetOfOneFrameIsSeenAndNotFittedAway) {
  variant("late", [](Episode& e) {
    std::vector<Landmark>& marks = e.landmarks[0].landmarks;
    for (std::size_t i = marks.size() - 1; i > 0; --i) marks[i].pixel = marks[i - 1].pixel;
  });
  ASSERT_EQ(replay("late", kPosed).exit_code, 0);
  // 50 mm, 75 px in the picture, are gone over between the first counted frame and the last: the sum of what it moves from frame to frame.
  const std::vector<std::string> counted = column(at("out_late/late/none/1/errors.csv"), "counted");
  const auto frames = static_cast<double>(std::count(counted.begin(), counted.end(), "1"));
  EXPECT_GT(frames, 15);
  EXPECT_NEAR(mean_error("late"), 75 / frames, 0.02 * 75 / frames);
}
TEST_F(ReplayCommand, TheLeadInIsNotCounted) {
  variant("stir",
          [](Episode& e) {
            for (Landmark& mark : e.landmarks[0].landmarks)
              if (mark.time < 0.3) mark.pixel.y() += 50;
          },
          {{"lead_in: 0.1", "lead_in: 0.3"}});
  ASSERT_EQ(replay("stir", kPosed).exit_code, 0);
  EXPECT_LT(mean_error("stir"), 0.05);
  const std::vector<std::string> errors = column(at("out_stir/frames.csv"), "error_px");
  EXPECT_GT(std::stod(errors.at(0)), 40) << "but it is shown";
}
TEST_F(ReplayCommand, LandmarksAfterTheMotionsAreLeftOutAndRemarkedOn) {
  variant("late_mark", [](Episode& e) { e.landmarks[0].landmarks.back().time = 5; });
  const Outcome outcome = replay("late_mark", kPosed);
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr("late_mark: note: "));
  EXPECT_LT(mean_error("late_mark"), 0.05);
}
/// What is in the folder of a run may be of another one, with other settings.
TEST_F(ReplayCommand, PicturesAreOfTheRunThatTheyNarrate) {
  variant("told_twice", nothing);
  const std::string folder_of_run = at("out_told_twice/told_twice/none/1");
  const auto run = [&](const std::vector<std::string>& more) {
    std::vector<std::string> arguments = kPosed;
    arguments.insert(arguments.end(), more.begin(), more.end());
    ASSERT_EQ(replay("told_twice", arguments).exit_code, 0);
  };
  const auto shown = [&] { return nlohmann::json::parse(read(folder_of_run + "/report.json"))["state_hash"].get<std::string>(); };
  run({});
  const std::string heavy = shown();
  run({"--set", "gravity=[0, 0, -5]"});
  EXPECT_NE(shown(), heavy);
  run({"--still", "0.5"});
  EXPECT_EQ(shown(), heavy);
}
TEST_F(ReplayCommand, AnEpisodeWithoutACameraIsReplayedAndNotScored) {
  variant_text("blind", {{"camera: ego\n", ""}, {"recording: blind.h5", "recording: real.h5"}});
  const Outcome outcome = replay("blind", kPosed);
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_EQ(column(at("out_blind/replay.csv"), "mean_px"), std::vector<std::string>{""});
}
/// The same recording as other programs would have written it.
TEST_F(ReplayCommand, FilesOfOthersScoreAsTheEpisodeThatHoldsTheSame) {
  const Episode real = cosim::read_episode(at("real.h5"));
  std::ostringstream motion, marks;
  motion.precision(17), marks.precision(17);
  motion << "stamp,slide_mm,half_mm\n";
  for (std::size_t i = 0; i < real.streams[0].times.size(); ++i) {
    const double slide = 1e3 * real.streams[0].measured[i][0];
    motion << real.streams[0].times[i] << ',' << slide << ',' << slide / 2 << '\n';
  }
  marks << "time_s,u [px],v [px],kind,visible,estimated\n";
  for (const Landmark& mark : real.landmarks[0].landmarks)
    marks << mark.time << ',' << mark.pixel.x() << ',' << mark.pixel.y() << ",rim,1,0\n";
  folder->file("motion.csv", motion.str()), folder->file("marks.csv", marks.str());
  folder->file("lens.yaml",
               "{fx: 600, fy: 600, cx: 423.5, cy: 239.5, width: 848, height: 480, distortion: [-0.28, 0.09, 0.0007, -0.0004, -0.012], "
               "position: [0.02, 0.01, 0.4255], rotation: [3.14159265358979, 0, 0]}\n");
  const std::string head =
      "episode: others\nscene: tray.yaml\ncamera: ego\nlead_in: 0.1\njoints: {slide: {drives: \"tray:slide\", unit: mm}}\n";
  const std::string motions = "  motion: [{csv: motion.csv, time: stamp, joints: {slide: {measured: slide_mm, unit: mm}}}]\n";
  const std::string seen = "  cameras: {ego: lens.yaml}\n  landmarks: {ego: {marks: marks.csv}}\n";
  folder->file("others.yaml", head + "recording:\n  origin: by hand\n" + motions + seen);
  const Outcome outcome = replay("others", kPosed);
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr("others: by hand"));
  EXPECT_LT(mean_error("others"), 0.05);
  variant_of_text("others", "slide_mm", "half_mm");
  ASSERT_EQ(replay("others", kPosed).exit_code, 0);
  EXPECT_GT(mean_error("others"), 10) << "another column of the same file: the run that is kept is not of it";

  const auto refused = [&](const std::string& recording) {
    folder->file("bad.yaml", head + "recording:\n" + recording);
    const Outcome bad = replay("bad", kPosed);
    EXPECT_EQ(bad.exit_code, 2);
    return bad.err;
  };
  EXPECT_THAT(refused(seen), AllOf(HasSubstr("recording.motion"), HasSubstr("missing"), HasSubstr("lerobot")));
  EXPECT_THAT(refused("  motion: [{cvs: motion.csv}]\n" + seen), AllOf(HasSubstr("bad.yaml:7"), HasSubstr("one of csv, lerobot, vendor")));
  EXPECT_THAT(refused("  motion: [{csv: none.csv, time: stamp, joints: {}}]\n"), HasSubstr("there is no such file"));
  EXPECT_THAT(refused(motions + "  cameras: {ego: lens.yaml}\n  landmarks: {ergo: {marks: marks.csv}}\n"), HasSubstr("ergo"));
  EXPECT_THAT(refused(motions + seen + "  photos: 3\n"), HasSubstr("recording.photos"));
}
/// Skipped where the data is absent. The arm's last positions are those of the recording's last row.
TEST_F(ReplayCommand, RecordingsOfRealRobotsMoveTheirModels) {
  const std::filesystem::path data = robot::test::real_data(), g1 = data / "g1_inspire_lerobot";
  if (!std::filesystem::exists(g1)) GTEST_SKIP() << "needs " << g1;
  folder->file("marvin.srdf",
               "<robot name=\"marvin\"><disable_collisions link1=\"Link3_L\" link2=\"Link5_L\"/><disable_collisions link1=\"Link5_L\" "
               "link2=\"Link7_L\"/></robot>");
  const std::string urdf = '"' + robot::test::marvin_arm().string() + '"',
                    strip = "film: vinyl_19mm\nstrip: {length: 0.05, position: [5, 0, 0]}\n";
  folder->file("marvin_scene.yaml", "scene: marvin_scene\ntime: {dt: 0.02}\n" + strip + "robots: {arm: {urdf: " + urdf +
                                        ", srdf: marvin.srdf, drives: {kp: 2000, kd: 100, compensate_gravity: true}}}\n");
  folder->file("marvin.yaml", "episode: marvin\nscene: marvin_scene.yaml\nrecording:\n  motion:\n    - vendor: \"" +
                                  (data / "marvin_m6_ccs" / "recordings" / "aa.txt").string() + "\"\n      urdf: " + urdf +
                                  "\n      columns: recorded\n      joints: [Joint1_L, Joint2_L, Joint3_L, Joint4_L, Joint5_L, Joint6_L, "
                                  "Joint7_L]\nlead_in: 0.1\njoints: {\"*\": {drives: \"arm:*\", unit: rad}}\n");
  const Outcome marvin = replay("marvin");
  ASSERT_EQ(marvin.exit_code, 0) << marvin.err;
  EXPECT_NEAR(last_position("marvin", 2), 90 * std::numbers::pi / 180, 0.01) << "the third joint goes from 0 to 90 deg";

  folder->file("station.yaml", "scene: station\ntime: {dt: 0.033333333333333333}\n" + strip +
                                   "robots: {station: {urdf: station.urdf, drives: {kp: 5000, kd: 300, compensate_gravity: true}}}\n");
  folder->file("g1.yaml", "episode: g1\nscene: station.yaml\nrecording:\n  motion:\n    - lerobot: \"" + g1.string() +
                              "\"\n      episode: 2\n      table: \"" + (g1 / "csv_converted" / "episode_000002.csv").string() +
                              "\"\n      unit: rad\n      units: {\"k*Hand*\": 1}\nstart: 10\nlead_in: 0.1\njoints:\n  \"*\": none\n"
                              "  kLeftElbow: {drives: \"station:left_arm_joint4\", unit: rad, sign: -1, offset: 1.5707}\n"
                              "  kLeftHandIndex: {drives: \"station:left_finger2_joint1\", unit: 1, scale: 1.2}\n");
  const Outcome teleoperated = replay("g1");
  EXPECT_EQ(teleoperated.exit_code, 0) << teleoperated.err;
}
TEST_F(ReplayCommand, PicturesShowPhotographsAndRunsSideBySide) {
  Picture dark(848, 480), light(848, 480);
  std::ranges::fill(light.rgb, std::uint8_t{200});
  std::filesystem::create_directory(at("photos"));
  tape::render::write_png(at("photos/a.png"), dark);
  tape::render::write_png(at("photos/b.png"), light);
  variant("shown", nothing, {{"camera: ego", "camera: ego\npictures: {folder: photos, rate: 2}"}});
  std::vector<std::string> arguments = kPosed;
  arguments.insert(arguments.end(), {"--video", "--still", "0", "--still", "0.5"});
  const Outcome outcome = replay("shown", arguments);
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_THAT(folder->names("out_shown"), testing::IsSupersetOf({"replay.png", "replay.svg"}));
  EXPECT_THAT(folder->names("out_shown/shown"), testing::UnorderedElementsAre("none", "still_0.png", "still_0.5.png", "video.mp4"));
  const Picture first = picture(at("out_shown/shown/still_0.png")), later = picture(at("out_shown/shown/still_0.5.png"));
  EXPECT_EQ(first.width, 2 * 848);
  EXPECT_EQ(first.at(600, 400)[0], 0) << "the photograph at 0 s";
  EXPECT_EQ(later.at(600, 400)[0], 200) << "that at 0.5 s";
  // The ring about the real landmark: 7 px beside the rim's centre, which moves from 393.5 px to 468.5 px between 0.1 s and 0.6 s. The
  // cross is drawn on the simulated one alone.
  EXPECT_GT(first.at(394 + 7, 255)[0], 200);
  EXPECT_EQ(first.at(394, 255)[2], 0) << "nothing is simulated in a photograph";
  EXPECT_GT(first.at(848 + 394, 255)[2], 150) << "the cross is blue";
}
TEST_F(ReplayCommand, TheStartIsShownOverThePhotographWithoutARun) {
  Picture light(848, 480);
  std::ranges::fill(light.rgb, std::uint8_t{255});
  std::filesystem::create_directory(at("first"));
  tape::render::write_png(at("first/a.png"), light);
  variant("alone", nothing);
  variant("over", nothing, {{"camera: ego", "camera: ego\npictures: {folder: first, rate: 2}"}});
  for (const char* name : {"alone", "over"}) {
    const Outcome outcome = replay(name, {"--start"});
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    EXPECT_THAT(folder->names(std::string("out_") + name), testing::ElementsAre(std::string("start_") + name + "_none.png"));
  }
  const Picture alone = picture(at("out_alone/start_alone_none.png")), over = picture(at("out_over/start_over_none.png"));
  for (const auto& [x, y] : {std::pair{394, 255}, std::pair{100, 100}, std::pair{340, 300}})
    EXPECT_NEAR(over.at(x, y)[1], (255 + alone.at(x, y)[1]) / 2.0, 1);
}
TEST_F(ReplayCommand, PicturesNeedACamera) {
  variant_text("unseen", {{"camera: ego\n", ""}, {"recording: unseen.h5", "recording: real.h5"}});
  const Outcome outcome = replay("unseen", {"--start"});
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_THAT(outcome.err, HasSubstr("unseen: names no camera"));
}
TEST_F(ReplayCommand, SettingsOfAnEpisodeGoToItsScene) {
  variant_text("set", {{"camera: ego\n", "camera: ego\nset: {exchange.schedule: posed, time.dt: 0.02}\n"}, {"set.h5", "real.h5"}});
  ASSERT_EQ(replay("set").exit_code, 0);
  const auto settings = nlohmann::json::parse(read(at("out_set/set/none/1/report.json")))["settings"];
  EXPECT_EQ(settings["exchange"]["schedule"], "posed");
  EXPECT_EQ(settings["time"]["dt"], 0.02);
  EXPECT_NEAR(settings["time"]["duration"], 0.8, 1e-12) << "as long as the recording";
}

TEST_F(ReplayCommand, LinksStandAtTheBeginningWhereTheyWereRecordedAtItsStart) {
  variant_text("later", {{"later.h5", "real.h5"}, {"start: 0\n", "start: 0.35\n"}});
  ASSERT_EQ(replay("later", kPosed).exit_code, 0);
  const cosim::StateReader states(at("out_later/later/none/1/state.h5"));
  const cosim::RecordedFrame first = states.frame(0);
  const auto& objects = states.mesh().objects;
  const auto tray = std::ranges::find(objects, "tray:tray", &cosim::RecordedObject::name) - objects.begin();
  // Halfway: the tray goes over 50 mm from 0.1 s to 0.6 s, the same forth as back.
  EXPECT_NEAR(first.bodies.at(static_cast<std::size_t>(tray)).position.x(), 0.025, 1e-3);
  EXPECT_NEAR(states.frame(states.frames() - 1).time, 0.45, 1e-9);
}
TEST_F(ReplayCommand, AGridGoesOnWhereItWas) {
  variant("first", nothing);
  variant("second", [](Episode& e) {
    for (Landmark& mark : e.landmarks[0].landmarks) mark.pixel.y() += 2;
  });
  const std::string plan = folder->file(
      "plan.yaml",
      "replay: both\nepisodes: [first.yaml, second.yaml]\nrepeats: 2\nset: {exchange.schedule: posed}\nbeside: {paper: {coh-f: 22.96}}\n");
  const auto run = [&](const std::vector<std::string>& more) {
    std::vector<std::string> arguments{"replay", plan, "--out", at("out_both")};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return tapesim(arguments);
  };
  ASSERT_EQ(run({"--repeats", "1"}).exit_code, 0);
  const auto times = column(at("out_both/runs.csv"), "seconds");
  EXPECT_EQ(times.size(), 2u);
  const Outcome whole = run({});
  ASSERT_EQ(whole.exit_code, 0) << whole.err;
  EXPECT_THAT(whole.err, HasSubstr("replay both: 0/160 ")) << "steps of two runs: two are kept";
  const auto all = column(at("out_both/runs.csv"), "seconds");
  ASSERT_EQ(all.size(), 4u);
  EXPECT_EQ(all[0], times[0]) << "not run again";
  EXPECT_EQ(all[2], times[1]);
  const auto hashes = column(at("out_both/runs.csv"), "state_hash");
  EXPECT_EQ(hashes[0], hashes[1]) << "repeats agree to the bit";
  EXPECT_NEAR(mean_error("both"), (std::stod(column(at("out_both/replay.csv"), "first_px").at(0)) + 2) / 2, 0.05);
  EXPECT_THAT(run({}).err, Not(HasSubstr("/160"))) << "nothing is left to do";
  EXPECT_EQ(column(at("out_both/runs.csv"), "seconds"), all);
}
TEST_F(ReplayCommand, CtrlCKeepsTheRunsThatAreDoneAndSaysHowToGoOn) {
  variant("long", nothing);
  Program program({"replay", at("long.yaml"), "--out", at("out_long"), "--set", "exchange.schedule=posed", "--set", "time.dt=1e-5"});
  ASSERT_TRUE(program.wait_for_error_text("replay long: "));
  program.signal(SIGINT);
  const Outcome outcome = program.wait();
  EXPECT_EQ(outcome.exit_code, 130) << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr("interrupted after 0 of 1 runs"));
}

TEST_F(ReplayCommand, BadEpisodesAreRefusedByName) {
  struct Bad {
    std::string name;
    std::function<void(const std::string&)> make;
    std::vector<std::string> says;
  };
  const auto edited = [](const std::vector<std::pair<std::string, std::string>>& texts) {
    return [=](const std::string& name) { variant(name, nothing, texts); };
  };
  const std::vector<Bad> all = {
      {"joint_missing",
       edited({{"\"tray:slide\": {drives: \"tray:slide\"", "\"tray:glide\": {drives: \"tray:slide\""}}),
       {"joint_missing.yaml", "joints.tray:glide", "no such joint"}},
      {"unit_wrong", edited({{"unit: m}", "unit: mm}"}}), {"unit_wrong.yaml", "unit = mm", "is recorded in m"}},
      {"turns",
       [](const std::string& name) {
         variant(name, [](Episode& e) { e.streams[0].joints[0].unit = cosim::Unit::rad; }, {{"unit: m}", "unit: rad}"}});
       },
       {"turns.yaml", "tray:slide slides", "recorded in rad"}},
      {"apart",
       [](const std::string& name) {
         variant(name, [](Episode& e) {
           cosim::MotionStream& late = e.streams.emplace_back(e.streams[0]);
           late.name = "late", late.joints[0].name = "late";
           for (double& t : late.times) t += 10;
         });
       },
       {"apart.yaml", "no time in common"}},
      {"nowhere",
       [](const std::string& name) { variant(name, [](Episode& e) { e.cameras[0].mount = "tray:nolink"; }); },
       {"nowhere.yaml", "a camera stands on tray:nolink"}},
      {"folded",
       [](const std::string& name) {
         variant(name, [](Episode& e) {
           e.cameras[0].calibration.lens = {.k1 = -0.5};
           e.landmarks[0].landmarks.back().pixel = {80, 239.5};
         });
       },
       {"folded.yaml", "the landmark of camera ego at 0.8 s"}},
      {"no_robot", edited({{"drives: \"tray:slide\"", "drives: \"arm:slide\""}}), {"no_robot.yaml", "arm:slide is of no robot"}},
      {"camera_wrong", edited({{"camera: ego", "camera: egg"}}), {"camera_wrong.yaml", "camera = egg", "ego, wrist"}},
      {"other_lens",
       [&](const std::string& name) {
         folder->file("hd.yaml", "{fx: 900, fy: 900, cx: 640, cy: 360, width: 1280, height: 720}");
         variant(name, nothing, {{"camera: ego", "camera: ego\ncalibration: hd.yaml"}});
       },
       {"hd.yaml", "1280 x 720 px", "848 x 480 px"}},
      {"late_marks",
       [](const std::string& name) {
         variant(name, [](Episode& e) {
           for (Landmark& mark : e.landmarks[0].landmarks) mark.time += 5;
         });
       },
       {"late_marks.yaml", "no landmark is visible", "to the end of the motions"}},
      {"no_marks",
       [](const std::string& name) { variant(name, [](Episode& e) { e.landmarks.erase(e.landmarks.begin()); }); },
       {"no_marks.yaml", "camera = ego", "no landmarks"}},
      {"no_hub",
       [](const std::string& name) { variant(name, [](Episode& e) { e.landmarks[0].body = "core"; }); },
       {"no_hub.yaml", "no body core"}},
  };
  for (const Bad& bad : all) {
    bad.make(bad.name);
    const Outcome outcome = replay(bad.name, kPosed);
    EXPECT_EQ(outcome.exit_code, 2) << bad.name << outcome.out;
    for (const std::string& text : bad.says) EXPECT_THAT(outcome.err, HasSubstr(text)) << bad.name;
    EXPECT_THAT(folder->names("out_" + bad.name), testing::Not(testing::Contains("replay.csv"))) << bad.name;
  }
}
TEST_F(ReplayCommand, ABadRecordingIsRefusedByFileAndRow) {
  // Written as bytes: write_episode refuses them itself.
  const std::string whole = read(at("real.h5"));
  folder->file("cut.h5", whole.substr(0, whole.size() / 2));
  variant_text("cut", {});
  const Outcome outcome = replay("cut", kPosed);
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_THAT(outcome.err, HasSubstr("cut.h5"));
}
TEST_F(ReplayCommand, ARecordingNeedsARobotACameraAndAHub) {
  const auto record = [&](const std::string& set) {
    return tapesim({"run", at("tray.yaml"), "--out", at("none"), "--record", at("none.h5"), "--set", set});
  };
  const Outcome no_camera = record("camera={eye: [0, -1, 1]}");
  EXPECT_EQ(no_camera.exit_code, 2);
  EXPECT_THAT(no_camera.err, HasSubstr("--record: the scene has no calibrated camera"));
  EXPECT_FALSE(std::filesystem::exists(at("none.h5")));
  const Outcome twins = record("camera.1.name=ego");
  EXPECT_EQ(twins.exit_code, 2);
  EXPECT_THAT(twins.err, HasSubstr("two cameras of the scene are named ego"));
  const Outcome nowhere = tapesim({"run", at("tray.yaml"), "--out", at("none"), "--record", at("nowhere/none.h5")});
  EXPECT_EQ(nowhere.exit_code, 2);
  EXPECT_FALSE(std::filesystem::exists(at("none"))) << "found before the run";
}
TEST_F(ReplayCommand, AnEpisodeWithNothingToScoreIsRefusedBeforeTheRun) {
  variant_text("unscored", {{"lead_in: 0.1", "lead_in: 3"}, {"recording: unscored.h5", "recording: real.h5"}});
  const Outcome outcome = replay("unscored", kPosed);
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_THAT(outcome.err, AllOf(HasSubstr("unscored.yaml"), HasSubstr("lead_in = 3"), HasSubstr("no landmark is visible")));
  EXPECT_FALSE(std::filesystem::exists(at("out_unscored")));
  variant_text("rare", {{"recording: rare.h5", "recording: real.h5"}});
  const Outcome rare = replay("rare", {"--set", "time.dt=0.2"});
  EXPECT_EQ(rare.exit_code, 2);
  EXPECT_THAT(rare.err, HasSubstr("has a state each 0.2 s"));
  EXPECT_FALSE(std::filesystem::exists(at("out_rare")));
}
TEST_F(ReplayCommand, ARunThatFailsBecomesNoEpisode) {
  const Outcome failed = tapesim({"run", at("tray.yaml"), "--out", at("failed"), "--record", at("failed.h5"), "--set",
                                  "solver.max_newton=1", "--set", "solver.retries=0", "--set", "solver.velocity_tol=1e-12"});
  EXPECT_EQ(failed.exit_code, 1);
  for (const char* file : {"failed.h5", "failed.yaml"}) EXPECT_FALSE(std::filesystem::exists(at(file))) << file;
}
