#include "apps/render/picture.hpp"

#include <gtest/gtest.h>
#include <png.h>
#include <unistd.h>

#include "tape/core/error.hpp"
using namespace tape;
using namespace tape::render;
namespace fs = std::filesystem;

TEST(Picture, APngHoldsThePixelsItWasGiven) {
  const fs::path path = fs::temp_directory_path() / ("tape_picture_test_" + std::to_string(getpid()) + ".png");
  Picture picture(5, 3);
  for (std::size_t i = 0; i < picture.rgb.size(); ++i) picture.rgb[i] = static_cast<std::uint8_t>(17 * i);
  write_png(path, picture);
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  ASSERT_TRUE(png_image_begin_read_from_file(&image, path.c_str()));
  image.format = PNG_FORMAT_RGB;
  EXPECT_EQ(image.width, 5u);
  EXPECT_EQ(image.height, 3u);
  std::vector<std::uint8_t> pixels(PNG_IMAGE_SIZE(image));
  ASSERT_TRUE(png_image_finish_read(&image, nullptr, pixels.data(), 0, nullptr));
  EXPECT_EQ(pixels, picture.rgb);
  fs::remove(path);
}

TEST(Picture, SideBySideEachKeepsItsPixels) {
  Picture left(2, 2), right(1, 2);
  left.at(1, 1)[0] = 10, right.at(0, 1)[2] = 20;
  const Picture both = side_by_side({left, right});
  EXPECT_EQ(both.width, 3);
  EXPECT_EQ(both.height, 2);
  EXPECT_EQ(both.at(1, 1)[0], 10);
  EXPECT_EQ(both.at(2, 1)[2], 20);
}

TEST(Picture, WhatIsPastedIsCutOffAtTheEdges) {
  Picture part(3, 2);
  std::fill(part.rgb.begin(), part.rgb.end(), std::uint8_t{9});
  const auto covered = [&](int x, int y) {
    Picture onto(4, 4);
    paste(onto, part, x, y);
    return std::count(onto.rgb.begin(), onto.rgb.end(), 9) / 3;
  };
  EXPECT_EQ(covered(1, 1), 6);
  EXPECT_EQ(covered(-2, 3), 1);
  EXPECT_EQ(covered(3, -1), 1);
  EXPECT_EQ(covered(4, 0) + covered(0, 4) + covered(-3, 0) + covered(0, -2), 0);
}

TEST(Picture, AFileThatCannotBeWrittenIsNamedAndNothingIsLeft) {
  const fs::path path = fs::temp_directory_path() / "no such folder" / "a.png";
  try {
    write_png(path, Picture(2, 2));
    ADD_FAILURE() << "accepted";
  } catch (const InputError& e) {
    EXPECT_NE(std::string(e.what()).find(path.string()), std::string::npos) << e.what();
  }
  EXPECT_FALSE(fs::exists(path.parent_path()));
}
