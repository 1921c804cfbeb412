#include "cosim/episode/episode_file.hpp"

#include <hdf5.h>

#include "cosim/run/hdf5_file.hpp"
#include "tests/cosim/episode/episodes.hpp"
using namespace cosim;
using cosim::test::expect_refused;
using cosim::test::small_episode;

namespace {
class EpisodeFile : public cosim::test::WithFolder {
 protected:
  std::filesystem::path file = folder / "episode.h5";

  /// Changes the file by the HDF5 library itself, as other programs do.
  template <class Change>
  void change(Change&& change_file) const {
    const hid_t id = H5Fopen(file.c_str(), H5F_ACC_RDWR, H5P_DEFAULT);
    change_file(id);
    H5Fclose(id);
  }
  /// Replaces a text by one of variable length, the form in which Python's h5py writes.
  void set_text(const char* array, const char* attribute, const char* text) const {
    change([&](hid_t id) {
      const hid_t object = H5Oopen(id, array, H5P_DEFAULT), type = H5Tcopy(H5T_C_S1), space = H5Screate(H5S_SCALAR);
      H5Tset_size(type, H5T_VARIABLE);
      H5Adelete(object, attribute);
      const hid_t made = H5Acreate2(object, attribute, type, space, H5P_DEFAULT, H5P_DEFAULT);
      H5Awrite(made, type, &text);
      H5Aclose(made), H5Sclose(space), H5Tclose(type), H5Oclose(object);
    });
  }
  void remove(const char* name) const {
    change([&](hid_t id) { H5Ldelete(id, name, H5P_DEFAULT); });
  }
  void expect_unreadable(std::initializer_list<std::string> says) const {
    expect_refused([&] { read_episode(file); }, says);
  }
};
}  // namespace

TEST_F(EpisodeFile, ReadsBackWhatWasWritten) {
  const Episode wrote = small_episode();
  write_episode(file, wrote);
  const Episode read = read_episode(file);
  EXPECT_EQ(read.name, "stick_19");
  EXPECT_EQ(read.origin, "made for a test");
  ASSERT_EQ(read.streams.size(), 2u);
  EXPECT_EQ(read.streams[0].name, "arm");
  EXPECT_EQ(read.streams[0].joints[1].name, "slide");
  EXPECT_EQ(read.streams[0].joints[1].unit, Unit::mm);
  EXPECT_EQ(read.streams[0].times, wrote.streams[0].times);
  EXPECT_EQ(read.streams[0].measured, wrote.streams[0].measured);
  EXPECT_EQ(read.streams[0].commanded, wrote.streams[0].commanded);
  EXPECT_EQ(read.streams[1].joints[0].unit, Unit::one);
  EXPECT_TRUE(read.streams[1].commanded.empty());
  ASSERT_EQ(read.cameras.size(), 2u);
  EXPECT_EQ(read.cameras[0].calibration.fx, 610);
  EXPECT_EQ(read.cameras[0].calibration.lens.k3, -.012);
  EXPECT_EQ(read.cameras[0].poses[0].rotation, wrote.cameras[0].poses[0].rotation);
  EXPECT_EQ(read.cameras[0].poses[0].position, wrote.cameras[0].poses[0].position);
  EXPECT_EQ(read.cameras[1].mount, "arm:flange");
  EXPECT_EQ(read.cameras[1].calibration.width, 640);
  EXPECT_EQ(read.cameras[1].times, wrote.cameras[1].times);
  EXPECT_EQ(read.cameras[1].poses[1].position, wrote.cameras[1].poses[1].position);
  ASSERT_EQ(read.landmarks.size(), 1u);
  ASSERT_EQ(read.landmarks[0].landmarks.size(), 3u);
  EXPECT_EQ(read.landmarks[0].body, "hub");
  EXPECT_FALSE(read.landmarks[0].undistorted);
  EXPECT_EQ(read.landmarks[0].landmarks[0].pixel, Vec2(400.25, 300.5));
  EXPECT_EQ(read.landmarks[0].landmarks[1].kind, LandmarkKind::side_box);
  EXPECT_TRUE(read.landmarks[0].landmarks[1].estimated);
  EXPECT_FALSE(read.landmarks[0].landmarks[0].estimated);
  EXPECT_FALSE(read.landmarks[0].landmarks[2].visible);
}
TEST_F(EpisodeFile, AnUnsoundEpisodeIsNotWritten) {
  Episode episode = small_episode();
  episode.streams[0].times[3] = -1;
  expect_refused([&] { write_episode(file, episode); }, {"episode.h5", "motion arm"});
  EXPECT_FALSE(std::filesystem::exists(file));
}
TEST_F(EpisodeFile, TextsOfOtherProgramsAreRead) {
  write_episode(file, small_episode());
  set_text("/", "name", "named by h5py");
  set_text("motion/hand/measured", "joints", "thumb_bend");
  const Episode read = read_episode(file);
  EXPECT_EQ(read.name, "named by h5py");
  EXPECT_EQ(read.streams[1].joints[0].name, "thumb_bend");
}
TEST_F(EpisodeFile, WhatIsMissingIsRefusedByName) {
  for (const char* name :
       {"motion/arm/time", "cameras/ego/intrinsics", "cameras/ego/pose", "landmarks/ego/kind", "landmarks/ego/visible"}) {
    write_episode(file, small_episode());
    remove(name);
    expect_unreadable({"episode.h5", name, "missing"});
    std::filesystem::remove(file);
  }
  write_episode(file, small_episode());
  remove("motion");
  expect_unreadable({"holds no motion"});
  expect_refused([&] { read_episode(folder / "other.h5"); }, {"other.h5", "no such file"});
  written("text.h5", "time,joint\n");
  expect_refused([&] { read_episode(folder / "text.h5"); }, {"text.h5", "not an HDF5 file"});
}
TEST_F(EpisodeFile, OtherUnitsFramesAndFormsAreRefusedByName) {
  const struct {
    const char *array, *attribute, *text, *says;
  } cases[] = {
      {"/", "format", "tapesim episode 2", "format 'tapesim episode 2' (allowed: tapesim episode 1)"},
      {"motion/arm/time", "unit", "ms", "unit of motion/arm/time is ms (allowed: s)"},
      {"motion/arm/measured", "units", "degrees, mm",
       "motion/arm/measured: unit 'degrees' of joint shoulder (allowed: rad, deg, m, mm, or 1"},
      {"motion/arm/measured", "units", "deg", "motion/arm/measured has 2 joints, 1 units"},
      {"motion/arm/measured", "joints", "shoulder, slide, elbow", "3 joints, 2 units"},
      {"motion/arm/commanded", "joints", "slide, shoulder", "motion/arm/commanded has other joints or units"},
      {"cameras/ego/distortion", "model", "kannala_brandt", "model of cameras/ego/distortion is kannala_brandt (allowed: brown_conrady)"},
      {"cameras/ego/pose", "unit", "mm", "unit of cameras/ego/pose is mm (allowed: m)"},
      {"landmarks/ego/pixel", "picture", "cropped", "'cropped' (allowed: as recorded, undistorted)"},
  };
  for (const auto& bad : cases) {
    write_episode(file, small_episode());
    set_text(bad.array, bad.attribute, bad.text);
    expect_unreadable({"episode.h5", bad.says});
    std::filesystem::remove(file);
  }
}
TEST_F(EpisodeFile, ArraysOfAnotherShapeAreRefusedByName) {
  Hdf5Writer writer(file);
  writer.write_text("format", "tapesim episode 1");
  writer.write_text("name", "short");
  writer.write_text("origin", "");
  writer.write("motion/arm/time", std::vector<double>{0, 1, 2}, {3});
  writer.write_text("motion/arm/time", "unit", "s");
  writer.write("motion/arm/measured", std::vector<double>{0, 1, 2, 3}, {2, 2});
  writer.write_text("motion/arm/measured", "joints", "a, b");
  writer.write_text("motion/arm/measured", "units", "rad, rad");
  writer.commit();
  expect_unreadable({"motion/arm/measured has shape [2, 2] (allowed: [3, 2])"});
}
