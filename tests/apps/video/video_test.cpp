#include "apps/video/video.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <array>
#include <cstdio>
#include <cstdlib>
#include <fstream>

#include "tape/core/error.hpp"
using namespace tape;
using namespace tape::video;
using render::Picture;
namespace fs = std::filesystem;

namespace {
const VideoSettings kSmall{.width = 96, .height = 64, .rate = 25};

class Video : public testing::Test {
 protected:
  void SetUp() override { fs::create_directories(folder); }
  void TearDown() override { fs::remove_all(folder); }
  fs::path folder = fs::temp_directory_path() / ("tape_video_test_" + std::to_string(getpid()));
  fs::path file = folder / "a video's.mp4";
};

Picture plain(std::uint8_t r, std::uint8_t g, std::uint8_t b) {
  Picture picture(kSmall.width, kSmall.height);
  for (std::size_t i = 0; i < picture.rgb.size(); i += 3) picture.rgb[i] = r, picture.rgb[i + 1] = g, picture.rgb[i + 2] = b;
  return picture;
}
std::string output_of(const std::string& command) {
  std::string text;
  std::FILE* pipe = popen(command.c_str(), "r");
  std::array<char, 4096> part;
  while (const std::size_t n = std::fread(part.data(), 1, part.size(), pipe)) text.append(part.data(), n);
  EXPECT_EQ(pclose(pipe), 0) << command;
  return text;
}
std::string quoted(const fs::path& path) { return "\"" + path.string() + "\""; }
void write_video(const fs::path& path, int pictures) {
  VideoWriter video(path, kSmall);
  for (int i = 0; i < pictures; ++i) video.add(plain(200, 60, 30));
  video.finish();
}
/// Sets an environment variable for as long as it lives.
struct Environment {
  std::string name, before;
  Environment(const std::string& n, const std::string& value) : name(n), before(std::getenv(n.c_str())) {
    setenv(name.c_str(), value.c_str(), 1);
  }
  ~Environment() { setenv(name.c_str(), before.c_str(), 1); }
};
/// What VideoWriter says when it is made, fed and finished.
std::string complaint(const fs::path& path, const VideoSettings& settings, const Picture& picture) {
  try {
    VideoWriter video(path, settings);
    for (int i = 0; i < 200; ++i) video.add(picture);
    video.finish();
  } catch (const InputError& e) {
    return e.what();
  }
  return "";
}
}  // namespace

TEST_F(Video, IsH264In420WithEachPictureAndTheIndexInFront) {
  write_video(file, 37);
  const std::string probe = output_of(
      "ffprobe -v error -count_frames -select_streams v:0 -of default=nw=1 -show_entries "
      "stream=codec_name,pix_fmt,width,height,r_frame_rate,nb_read_frames,color_space " +
      quoted(file));
  for (const char* line :
       {"codec_name=h264", "pix_fmt=yuv420p", "width=96", "height=64", "r_frame_rate=25/1", "nb_read_frames=37", "color_space=bt709"})
    EXPECT_NE(probe.find(std::string(line) + "\n"), std::string::npos) << line << " is not in\n" << probe;
  std::ifstream stream(file, std::ios::binary);
  const std::string bytes{std::istreambuf_iterator<char>(stream), {}};
  EXPECT_LT(bytes.find("moov"), bytes.find("mdat"));
  EXPECT_EQ(std::distance(fs::directory_iterator(folder), fs::directory_iterator()), 1) << "the temporary file is gone";
}

TEST_F(Video, KeepsTheColours) {
  write_video(file, 3);
  const std::string pixels = output_of("ffmpeg -v error -i " + quoted(file) + " -frames:v 1 -f rawvideo -pix_fmt rgb24 -");
  ASSERT_EQ(pixels.size(), 3u * 96 * 64);
  constexpr std::size_t middle = 3 * (std::size_t{32} * 96 + 48);
  const std::array<int, 3> expected{200, 60, 30};
  for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR(static_cast<unsigned char>(pixels[middle + k]), expected[k], 4);
}

TEST_F(Video, SaysSoWhereFfmpegIsMissing) {
  const Environment path("PATH", folder.string());
  const std::string text = complaint(file, kSmall, plain(0, 0, 0));
  EXPECT_NE(text.find("ffmpeg"), std::string::npos) << text;
  EXPECT_NE(text.find("install"), std::string::npos) << text;
  EXPECT_TRUE(fs::is_empty(folder));
  EXPECT_THROW(require_ffmpeg(), InputError);
}

TEST_F(Video, RepeatsWhatFfmpegSaysWhereItFails) {
  const fs::path nowhere = folder / "no such folder" / "a.mp4";
  const std::string text = complaint(nowhere, kSmall, plain(0, 0, 0));
  EXPECT_NE(text.find(nowhere.string() + ": ffmpeg failed: "), std::string::npos) << text;
  EXPECT_NE(text.find("No such file or directory"), std::string::npos) << text;
}

TEST_F(Video, LeavesNothingWithoutFinish) {
  {
    VideoWriter video(file, kSmall);
    for (int i = 0; i < 100; ++i) video.add(plain(1, 2, 3));
  }
  EXPECT_TRUE(fs::is_empty(folder));
}

TEST_F(Video, RefusesOddSizesAndPicturesOfAnotherSize) {
  EXPECT_NE(complaint(file, {.width = 97, .height = 64}, plain(0, 0, 0)).find("video.width = 97"), std::string::npos);
  EXPECT_NE(complaint(file, {.rate = 0}, plain(0, 0, 0)).find("video.rate"), std::string::npos);
  EXPECT_NE(complaint(file, kSmall, Picture(64, 64)).find("64 x 64"), std::string::npos);
}
