#include "cosim/episode/import.hpp"

#include "cosim/episode/episode_file.hpp"
#include "robot/urdf/read_urdf.hpp"
#include "tests/cosim/episode/episodes.hpp"
#include "tests/robot/support/real_data.hpp"
using namespace cosim;
using cosim::test::expect_refused;

namespace {
class Import : public cosim::test::WithFolder {
 protected:
  const std::vector<TableJoint> joints{{.name = "elbow", .unit = Unit::deg, .measured = "q2", .commanded = "c2"},
                                       {.name = "shoulder", .unit = Unit::rad, .measured = "q1", .commanded = "c1"}};

  /// A data set of two joints at 10 Hz whose episode 3 has three rows.
  void write_lerobot(const std::string& version = "v2.1") const {
    std::filesystem::create_directories(folder / "meta");
    written("meta/info.json", R"({"codebase_version": ")" + version + R"(", "fps": 10, "features": {
      "observation.state": {"dtype": "float32", "shape": [2], "names": [["arm", "grip"]]},
      "action": {"dtype": "float32", "shape": [2], "names": ["arm", "grip"]}}})");
    written("meta/episodes.jsonl", "{\"episode_index\": 2, \"length\": 99}\n{\"episode_index\": 3, \"length\": 3}\n");
  }
  std::filesystem::path table(const std::string& rows = "0,0.1,0,0.2,0\n0.1,0.3,0.5,0.4,0.5\n0.2,0.5,1,0.6,1\n") const {
    return written("episode_000003.csv", "timestamp,state.arm,state.grip,action.arm,action.grip\n" + rows);
  }
  MotionStream lerobot(const std::filesystem::path& csv, const LeRobotUnits& units = {.of = {{"grip", Unit::one}}}) const {
    return import_lerobot(folder, 3, csv, units);
  }
};
}  // namespace

TEST_F(Import, ColumnsOfATableBecomeJointsByName) {
  const MotionStream motion =
      import_csv(written("t.csv", "stamp,q1,q2,c1,c2,note\n# by hand\n1.0,0.1,10,0.2,20,7\n1.1,0.3,30,0.4,40,7\n"), "arm", "stamp", joints);
  EXPECT_EQ(motion.name, "arm");
  EXPECT_EQ(motion.joints[0].name, "elbow");
  EXPECT_EQ(motion.joints[0].unit, Unit::deg);
  EXPECT_EQ(motion.times, std::vector<Real>({1.0, 1.1}));
  EXPECT_EQ(motion.measured[1], Vec2(30, 0.3));
  EXPECT_EQ(motion.commanded[0], Vec2(20, 0.2));
}
TEST_F(Import, BadTablesAreRefusedByLineAndColumn) {
  const auto refused = [&](const std::string& text, std::initializer_list<std::string> says) {
    const std::filesystem::path file = written("t.csv", text);
    expect_refused([&] { import_csv(file, "arm", "stamp", joints); }, says);
  };
  const std::string header = "stamp,q1,q2,c1,c2\n";
  refused("stamp,q1,c1,c2\n1,0,0,0\n2,0,0,0\n", {"t.csv:1: column q2 is missing"});
  refused(header + "1,0,0,0,0\n0.9,0,0,0,0\n", {"t.csv:3: ", "(stamp)", "0.9 s is not after 1 s"});
  refused(header + "1,0,nan,0,0\n2,0,0,0,0\n", {"t.csv:2: column 3 (q2): nan is no finite number"});
  refused(header + "1,0,,0,0\n2,0,0,0,0\n", {"t.csv:2: column 3 (q2): is empty"});
  refused(header + "1,0,0,0,0\n", {"at least 2"});
  const std::vector<TableJoint> half{{.name = "a", .measured = "q1", .commanded = "c1"}, {.name = "b", .measured = "q2"}};
  expect_refused([&] { import_csv(written("t.csv", header + "1,0,0,0,0\n2,0,0,0,0\n"), "arm", "stamp", half); }, {"1 of 2 joints"});
  expect_refused([&] { import_csv(folder / "none.csv", "arm", "stamp", joints); }, {"none.csv: cannot be read"});
}
TEST_F(Import, ALeRobotEpisodeHasStatesAndActionsInTheUnitsThatAreStated) {
  write_lerobot();
  const MotionStream motion = lerobot(table());
  EXPECT_EQ(motion.joints[0].name, "arm");
  EXPECT_EQ(motion.joints[0].unit, Unit::rad);
  EXPECT_EQ(motion.joints[1].unit, Unit::one);
  EXPECT_EQ(motion.measured[2], Vec2(0.5, 1));
  EXPECT_EQ(motion.commanded[1], Vec2(0.4, 0.5));
}
TEST_F(Import, BadLeRobotEpisodesAreRefused) {
  write_lerobot();
  expect_refused([&] { lerobot(folder / "episode_000003.parquet"); }, {"episode_000003.parquet: Parquet is not read; convert", "pandas"});
  expect_refused([&] { import_lerobot(folder, 4, table(), {}); }, {"episodes.jsonl: there is no episode 4"});
  expect_refused([&] { lerobot(table("0,0,0,0,0\n0.1,0,0,0,0\n")); }, {"has 2 rows (allowed: 3"});
  expect_refused([&] { lerobot(table("0,0,0,0,0\n1,0,0,0,0\n2,0,0,0,0\n")); }, {"has 1 rows a second (allowed: 10"});
  expect_refused([&] { lerobot(table(), {.of = {{"grab", Unit::one}}}); }, {"there is no joint grab", "arm, grip"});
  write_lerobot("v3.0");
  expect_refused([&] { lerobot(table()); }, {"info.json: codebase_version = v3.0 (allowed: v2.1)"});
  written("meta/info.json", "{");
  expect_refused([&] { lerobot(table()); }, {"info.json: is no JSON"});
}
TEST_F(Import, LandmarksAreReadAndBadOnesRefused) {
  const std::string header = "time_s, u [px], v [px], kind, visible, estimated\n";
  const LandmarkTrack track = import_landmarks(
      written("l.csv", header + "0.5, 400.25, 300, rim, 1, 0\n1, 1, 2, side_box, 1, 1\n1.5, , , rim, 0, 0\n"), {.camera = "ego"});
  ASSERT_EQ(track.landmarks.size(), 3u);
  EXPECT_EQ(track.camera, "ego");
  EXPECT_EQ(track.landmarks[0].pixel, Vec2(400.25, 300));
  EXPECT_EQ(track.landmarks[1].kind, LandmarkKind::side_box);
  EXPECT_TRUE(track.landmarks[1].estimated);
  EXPECT_FALSE(track.landmarks[2].visible);
  const auto refused = [&](const std::string& text, std::initializer_list<std::string> says) {
    expect_refused([&] { import_landmarks(written("l.csv", text), {.camera = "ego"}); }, says);
  };
  refused("t, u, v\n", {"l.csv:1: is another header (allowed: time_s, u [px]"});
  refused(header + "0.5, 400, 300, hole, 1, 0\n", {"l.csv:2: column 4 (kind): hole (allowed: rim, side_box)"});
  refused(header + "0.5, , 300, rim, 1, 0\n", {"l.csv:2: column 2 (u [px]): is empty"});
  refused(header + "0.5, 1, 2, rim, yes, 0\n", {"column 5 (visible): yes (allowed: 0, 1)"});
  refused(header + "0.5, 1, 2, rim, 1\n", {"has 5 columns (allowed: 6)"});
}
TEST_F(Import, RealTeleoperationOfARobotWithHandsBecomesAnEpisode) {
  const std::filesystem::path set = robot::test::real_data() / "g1_inspire_lerobot", csv = set / "csv_converted" / "episode_000002.csv";
  if (!std::filesystem::exists(csv)) GTEST_SKIP() << csv << " is absent: set TAPE_REAL_DATA";
  const LeRobotUnits units{.of = {{"k*Hand*", Unit::one}}};
  Episode episode{.name = "bottle", .origin = csv.string(), .streams = {import_lerobot(set, 2, csv, units)}};
  write_episode(folder / "bottle.h5", episode);
  const MotionStream motion = read_episode(folder / "bottle.h5").streams[0];
  EXPECT_EQ(motion.times.size(), 343u);  // as its episodes.jsonl says
  EXPECT_EQ(motion.joints.size(), 26u);
  EXPECT_EQ(motion.joints[14].name, "kLeftHandPinky");
  EXPECT_NEAR(motion.times[342], 342 / 30.0, 1e-5);
  expect_refused([&] { import_lerobot(set, 2, set / "data" / "chunk-000" / "episode_000002.parquet", units); }, {"Parquet is not read"});
  expect_refused([&] { import_lerobot(set, 3, csv, units); }, {"has 343 rows (allowed: 459"});
}
TEST_F(Import, RecordingsAndCommandsOfARealArmBecomeMotions) {
  const std::filesystem::path recordings = robot::test::real_data() / "marvin_m6_ccs" / "recordings", urdf = robot::test::marvin_arm();
  if (!std::filesystem::exists(urdf)) GTEST_SKIP() << urdf << " is absent: set TAPE_REAL_DATA";
  const robot::RobotModel model = robot::read_urdf(urdf);
  std::vector<std::string> names;
  for (const robot::Joint& joint : model.joints) names.push_back(joint.name);
  const MotionStream measured = import_vendor(recordings / "aa.txt", "arm", model, names, robot::VendorColumns::recorded);
  EXPECT_EQ(measured.times.size(), 1000u);
  EXPECT_TRUE(measured.commanded.empty());
  EXPECT_NEAR(measured.measured[0][6], 5.021967 * std::numbers::pi / 180, 1e-12);
  const MotionStream commanded = import_vendor(recordings / "PLN_MOVL_KEEPJ.txt", "arm", model, names, robot::VendorColumns::command);
  EXPECT_EQ(commanded.times.size(), 2107u);
  EXPECT_TRUE(commanded.measured.empty());
  EXPECT_NO_THROW(require_sound({.name = "vendor", .streams = {measured}}, "aa.txt"));
}
