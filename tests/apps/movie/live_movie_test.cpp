#include "apps/movie/live_movie.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <fstream>
#include <iterator>

#include "tape/core/error.hpp"
#include "tests/apps/movie/motion.hpp"

using namespace tape;
using namespace tape::movie;
using test::movie_frame, test::movie_mesh, test::movie_params;
namespace fs = std::filesystem;

namespace {
const Watch kGoOn = [](int, int) { return true; };
std::string bytes(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}
class Live : public testing::Test {
 protected:
  Live() {
    fs::create_directories(folder);
    for (int i = 0; i <= 12; ++i) frames.push_back(movie_frame(i, 0.1 * i, 0.02 + 0.005 * i, i < 7 ? 0 : 1, i));
    for (std::size_t i = 5; i < frames.size(); ++i) frames[i].mesh = 1;
    params.overlay = {"pull"};
  }
  ~Live() override { fs::remove_all(folder); }
  void feed(LiveMovie& movie) const {
    movie.start_mesh(movie_mesh());
    for (const RecordedFrame& frame : frames) {
      if (frame.step == 5) movie.start_mesh(movie_mesh());
      movie.add(frame);
    }
  }
  /// The same states as a file, and the movie of that.
  void movie_afterwards(const fs::path& file) const {
    {
      cosim::StateWriter writer(folder / "state.h5", movie_mesh());
      for (const RecordedFrame& frame : frames) {
        if (frame.step == 5) writer.start_mesh(movie_mesh());
        writer.add(frame);
      }
      writer.commit();
    }
    ASSERT_TRUE(write_video(cosim::StateReader(folder / "state.h5"), params, file, kGoOn));
  }
  fs::path folder = fs::temp_directory_path() / ("tape_live_movie_test_" + std::to_string(getpid()));
  PictureParams params = movie_params();
  std::vector<RecordedFrame> frames;
};
}  // namespace

TEST_F(Live, TheFilmIsThatOfTheRecordingToTheByte) {
  fs::create_directories(folder / "live");
  LiveMovie movie(params, folder / "live" / "video.mp4");
  feed(movie);
  EXPECT_EQ(movie.finish(kGoOn), LiveMovie::End::made);
  EXPECT_EQ(movie.pictures(), 13);
  EXPECT_GT(movie.seconds(), 0);
  movie_afterwards(folder / "video.mp4");
  for (const char* name : {"video.mp4", "still_lift.png", "still_hold.png"}) {
    EXPECT_GT(bytes(folder / name).size(), 500u) << name;
    EXPECT_TRUE(bytes(folder / name) == bytes(folder / "live" / name)) << name;
  }
}
TEST_F(Live, AMotionThatLeavesItsStageEndsItWithoutAFile) {
  frames[9] = movie_frame(9, 0.9, 0.5, 1);
  frames[9].mesh = 1;
  LiveMovie movie(params, folder / "video.mp4");
  feed(movie);
  EXPECT_EQ(movie.finish(kGoOn), LiveMovie::End::left_stage);
  EXPECT_TRUE(fs::is_empty(folder));
}
TEST_F(Live, OneThatIsGivenUpLeavesNothing) {
  {
    LiveMovie movie(params, folder / "video.mp4");
    feed(movie);
  }
  EXPECT_TRUE(fs::is_empty(folder));
  LiveMovie movie(params, folder / "video.mp4");
  feed(movie);
  for (int i = 13; i < 1000; ++i) movie.add(movie_frame(i, 0.1 * i, 0.02, 1));
  EXPECT_EQ(movie.finish([](int, int) { return false; }), LiveMovie::End::stopped);
  EXPECT_TRUE(fs::is_empty(folder));
}
TEST_F(Live, WhatGoesWrongIsSaidAtTheEnd) {
  std::get<render::LookAtSettings>(params.cameras[0].lens).follow = "moon";
  LiveMovie movie(params, folder / "video.mp4");
  feed(movie);
  EXPECT_THROW(movie.finish(kGoOn), InputError);
  EXPECT_TRUE(fs::is_empty(folder));
}
