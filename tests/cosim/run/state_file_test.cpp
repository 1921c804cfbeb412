#include "cosim/run/state_file.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <fstream>
#include <iterator>
#include <limits>

#include "tape/core/error.hpp"

using namespace cosim;
namespace fs = std::filesystem;

namespace {
/// A triangle of a strip and one on a body.
const RecordedMesh kMesh{
    .scene = "two triangles",
    .objects = {{"tape", "vinyl", 0, 1, true}, {"box", "wood", 1, 1, false}},
    .triangles = {{0, 1, 2}, {3, 4, 5}},
    .rest = {{0, 0}, {1, 0}, {0, 1}, {0, 0}, {0, 0}, {0, 0}},
    .body = {-1, -1, -1, 0, 0, 0},
    .local = {{0, 0, 0}, {0, 0, 0}, {0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}},
    .strip_vertices = 3,
    .pictures = "fov: 30\n",
    .robots = {{"arm",
                {"shoulder", "elbow"},
                {"base", "upper", "lower"},
                {{"camera lens", 2, Eigen::Translation3d(0.1, -0.2, 0.3) * Eigen::AngleAxisd(1.1, Vec3(0.6, 0, -0.8))}}},
               {"stand", {}, {"post"}}},
    .settings = "{}",
    .grips = {"pull", "tie"},
    .phases = {"close", "press"}};
/// A robot whose numbers tell each other apart.
cosim::RobotRecord robot_record(int joints, int links, double first) {
  const auto count = [&](double from) { return robot::VecX(robot::VecX::LinSpaced(joints, from, from + joints - 1)); };
  cosim::RobotRecord record{count(first), count(first + 10), count(first + 20), count(first + 30), {}};
  for (int l = 0; l < links; ++l) {
    record.links.emplace_back(Eigen::Translation3d(first, l, 0) * Eigen::AngleAxisd(0.1 * l, Eigen::Vector3d::UnitX()));
    record.wrench.emplace_back(Eigen::Matrix<double, 6, 1>::LinSpaced(first + l, first + l + 5));
  }
  return record;
}

RecordedFrame frame(int step) {
  Pose quarter_turn_about_z;
  quarter_turn_about_z.rotation << 0, -1, 0, 1, 0, 0, 0, 0, 1;
  quarter_turn_about_z.position = Vec3(0, 0, step);
  return {.step = step,
          .time = 0.1 * step,
          .x = {Vec3(step, 1, 2), Vec3(3, 4, 5), Vec3(6, 7, 8)},
          .bodies = {quarter_turn_about_z},
          .contact_force = {0.5, 1, 0, 0, 0, 0.25},
          .engagement = {0, 0.5, 1},
          .part = {tape::TapePart::free, tape::TapePart::collar, tape::TapePart::cluster},
          .robots = {robot_record(2, 3, step), robot_record(0, 1, 7)},
          .grip_force = {Vec3(1, 2, step), Vec3(0, 0, -3)},
          .phase = step > 0 ? 1 : -1};
}

class StateFile : public testing::Test {
 protected:
  StateFile() { fs::create_directories(folder); }
  ~StateFile() override { fs::remove_all(folder); }
  fs::path folder = fs::temp_directory_path() / ("state_file_test_" + std::to_string(getpid()));
  fs::path file = folder / "state.h5";
};
}  // namespace

TEST_F(StateFile, ReadsBackWhatWasWritten) {
  {
    StateWriter writer(file, kMesh);
    for (int step : {0, 5, 9}) writer.add(frame(step));
    EXPECT_FALSE(fs::exists(file)) << "it has its name before it is complete";
    writer.commit();
  }
  const StateReader reader(file);
  ASSERT_EQ(reader.frames(), 3);
  EXPECT_EQ(reader.mesh().scene, kMesh.scene);
  EXPECT_EQ(reader.mesh().pictures, kMesh.pictures);
  EXPECT_EQ(reader.mesh().grips, kMesh.grips);
  EXPECT_EQ(reader.mesh().phases, kMesh.phases);
  EXPECT_EQ(reader.mesh().triangles, kMesh.triangles);
  EXPECT_EQ(reader.mesh().objects[1].name, "box");
  EXPECT_EQ(reader.mesh().objects[1].material, "wood");
  const RecordedFrame read = reader.frame(1), written = frame(5);
  EXPECT_EQ(read.step, 5);
  EXPECT_EQ(read.time, written.time);
  EXPECT_EQ(read.x, written.x);
  EXPECT_EQ(read.bodies[0].rotation, written.bodies[0].rotation);
  EXPECT_EQ(read.contact_force, written.contact_force);
  EXPECT_EQ(read.engagement, written.engagement);
  EXPECT_EQ(read.part, written.part);
  EXPECT_EQ(read.grip_force, written.grip_force);
  EXPECT_EQ(read.phase, 1);
  EXPECT_EQ(reader.frame(0).phase, -1);
  EXPECT_EQ(reader.mesh().robots, kMesh.robots);
  ASSERT_EQ(reader.mesh().robots[0].frames.size(), 1u);
  const robot::Frame &lens = reader.mesh().robots[0].frames[0], &kept = kMesh.robots[0].frames[0];
  EXPECT_EQ(lens.name, "camera lens");
  EXPECT_EQ(lens.link, 2);
  EXPECT_TRUE(lens.X_LF.isApprox(kept.X_LF, 1e-15));
  EXPECT_TRUE(reader.mesh().robots[1].frames.empty());
  EXPECT_EQ(reader.mesh().settings, "{}");
  ASSERT_EQ(read.robots.size(), 2u);
  for (std::size_t r = 0; r < 2; ++r) {
    const cosim::RobotRecord &a = read.robots[r], &b = written.robots[r];
    EXPECT_EQ(a.position, b.position);
    EXPECT_EQ(a.velocity, b.velocity);
    EXPECT_EQ(a.command, b.command);
    EXPECT_EQ(a.effort, b.effort);
    EXPECT_EQ(a.wrench, b.wrench);
    for (std::size_t l = 0; l < b.links.size(); ++l) EXPECT_TRUE(a.links[l].isApprox(b.links[l], 1e-15));
  }
}
TEST_F(StateFile, VerticesOfBodiesFollowTheirPose) {
  const std::vector<Vec3> x = vertex_positions(kMesh, frame(2));
  EXPECT_EQ(x[0], Vec3(2, 1, 2));
  EXPECT_EQ(x[3], Vec3(0, 1, 2));  // x turned to y, and 2 m up
  EXPECT_EQ(x[4], Vec3(-1, 0, 2));
}
TEST_F(StateFile, LeavesNothingBehindUnlessCommitted) {
  { StateWriter(file, kMesh).add(frame(0)); }
  EXPECT_TRUE(fs::is_empty(folder));
}
TEST_F(StateFile, AMissingOrDamagedFileIsRefusedByName) {
  EXPECT_THROW(StateReader(folder / "none.h5"), tape::InputError);
  StateWriter writer(file, kMesh);
  writer.add(frame(0));
  writer.commit();
  std::ifstream whole(file, std::ios::binary);
  const std::string bytes{std::istreambuf_iterator<char>(whole), {}};
  std::ofstream(folder / "cut.h5", std::ios::binary) << bytes.substr(0, bytes.size() / 2);
  try {
    const StateReader reader(folder / "cut.h5");
    ADD_FAILURE();
  } catch (const tape::InputError& e) {
    EXPECT_NE(std::string(e.what()).find("cut.h5"), std::string::npos);
  }
}
TEST_F(StateFile, ArraysThatDoNotFitTogetherAreRefused) {
  const auto refused = [&](const RecordedMesh& mesh, const RecordedFrame& first) {
    {
      StateWriter writer(file, mesh);
      writer.add(first);
      writer.commit();
    }
    try {
      const StateReader reader(file);
      reader.frame(0);
    } catch (const tape::InputError& e) {
      return std::string(e.what()).find("damaged") != std::string::npos;
    }
    return false;
  };
  EXPECT_FALSE(refused(kMesh, frame(0)));
  RecordedMesh of_no_body = kMesh, of_no_vertex = kMesh;
  of_no_body.body[4] = 1;
  of_no_vertex.triangles[1] = {3, 4, 6};
  EXPECT_TRUE(refused(of_no_body, frame(0)));
  EXPECT_TRUE(refused(of_no_vertex, frame(0)));
  RecordedFrame short_frame = frame(0), not_finite = frame(0);
  short_frame.x.pop_back();
  not_finite.x[1].y() = std::numeric_limits<Real>::quiet_NaN();
  RecordedFrame of_no_phase = frame(0);
  of_no_phase.phase = 2;
  EXPECT_TRUE(refused(kMesh, of_no_phase));
  EXPECT_TRUE(refused(kMesh, short_frame));
  EXPECT_TRUE(refused(kMesh, not_finite));
}
TEST(NewFile, AFullDiskIsAnInputErrorThatNamesTheFile) {
  if (!fs::exists("/dev/full")) GTEST_SKIP() << "no /dev/full";
  const fs::path folder = fs::temp_directory_path() / ("new_file_test_" + std::to_string(getpid()));
  fs::create_directories(folder);
  fs::create_symlink("/dev/full", folder / ("." + std::to_string(getpid()) + ".report.json"));
  try {
    write_text(folder / "report.json", std::string(100, 'x'));
    ADD_FAILURE();
  } catch (const tape::InputError& e) {
    EXPECT_NE(std::string(e.what()).find("No space left"), std::string::npos) << e.what();
  }
  EXPECT_TRUE(fs::is_empty(folder));
  fs::remove_all(folder);
}
