#include "apps/movie/params.hpp"

#include <gtest/gtest.h>

#include "cosim/scene/scene_file.hpp"
#include "tape/core/error.hpp"

using namespace tape;
using namespace tape::movie;

namespace {
const std::vector<std::string> kBearers{"pull", "arm:hand"};
const std::string kMovie = R"(video: {color: tension, overlay: [pull, "arm:hand"], rate: 25}
camera:
  - {eye: [1, 0, 0.5], target: [0, 0, 0], follow: tape}
  - {eye: [0, 1, 0.5], target: [0, 0, 0]}
  - {eye: [0.2, 0, 0.1], target: [0, 0, 0], fov: 20, inset: {corner: top_right, width: 0.25}}
  - {eye: [0, 0.2, 0.1], target: [0, 0, 0], mount: "arm:hand", inset: {}}
)";
PictureParams read(const std::string& text) {
  const cosim::SceneFile file = cosim::SceneFile::parse(text, "movie.yaml");
  PictureParams params = read_pictures(file.root(), kBearers);
  file.require_all_used();
  return params;
}
std::string refusal(const std::string& text) {
  try {
    read(text);
  } catch (const InputError& e) {
    return e.what();
  }
  return "";
}
}  // namespace

TEST(PictureParams, AreReadWithInsetsAndOverlay) {
  const PictureParams params = read(kMovie);
  EXPECT_EQ(params.view.color, render::ColorBy::tension);
  EXPECT_EQ(params.overlay, kBearers);
  EXPECT_EQ(params.video.rate, 25);
  EXPECT_EQ(params.video.width, 1280);
  EXPECT_EQ(params.video.height, 720);
  ASSERT_EQ(params.cameras.size(), 4u);
  EXPECT_FALSE(params.cameras[0].inset || params.cameras[1].inset);
  EXPECT_EQ(params.cameras[2].inset->corner, Corner::top_right);
  EXPECT_EQ(params.cameras[2].inset->width, 0.25);
  EXPECT_EQ(params.cameras[3].inset->corner, Corner::bottom_right);
}
TEST(PictureParams, ComeBackFromTheTextThatARecordingKeeps) {
  for (const std::string& text :
       {kMovie, std::string("camera: {fx: 100, fy: 90, width: 640, mount: 'arm:hand'}\n"), std::string("camera: []\n")}) {
    const std::string kept = pictures_text(read(text));
    EXPECT_EQ(pictures_text(parse_pictures(kept, kBearers)), kept) << text;
  }
  const PictureParams again = parse_pictures(pictures_text(read(kMovie)), kBearers);
  EXPECT_EQ(again.overlay, kBearers);
  EXPECT_EQ(again.view.color, render::ColorBy::tension);
  EXPECT_EQ(std::get<render::LookAtSettings>(again.cameras[3].lens).mount, "arm:hand");
  EXPECT_EQ(again.cameras[2].inset->width, 0.25);
}
TEST(PictureParams, AreRefusedByFileLineAndKey) {
  const struct {
    const char* text;
    std::vector<const char*> says;
  } cases[] = {
      {"camera: {eye: [1, 0, 0], inset: {}}", {"movie.yaml:1: camera.inset", "no camera without inset"}},
      {"camera: [{eye: [1, 0, 0]}, {eye: [0, 1, 0], inset: {}}, {eye: [0, 1, 0], inset: {width: 0.2}}]",
       {"camera.2.inset", "another inset in this corner"}},
      {"camera: [{eye: [1, 0, 0]}, {eye: [0, 1, 0], inset: {corner: middle}}]", {"camera.1.inset.corner = middle", "top_left"}},
      {"camera: [{eye: [1, 0, 0]}, {eye: [0, 1, 0], inset: {width: 2}}]", {"camera.1.inset.width = 2", "[0.05, 0.9]"}},
      {"camera: [{eye: [1, 0, 0]}, {eye: [0, 1, 0], inset: {wide: 1}}]", {"camera.1.inset.wide", "unknown key"}},
      {"camera: {fx: 100, fy: 100, inset: {}}", {"camera.inset", "no inset"}},
      {"video: {overlay: [push]}", {"video.overlay.0 = push", "did you mean pull?"}},
      {"video: {width: 321}", {"video.width = 321", "must be even"}},
  };
  for (const auto& c : cases)
    for (const char* words : c.says) EXPECT_NE(refusal(c.text).find(words), std::string::npos) << c.text << "\n" << refusal(c.text);
}
