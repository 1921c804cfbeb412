#pragma once
#include <filesystem>

#include "apps/render/picture.hpp"
#include "apps/score/score.hpp"

/// Pictures that show simulated and real things together, to judge a start or a score by eye.
namespace tape::score {
/// A photograph: PNG, JPEG, or what else OpenCV reads.
/// @throws InputError if it cannot be read, or has another size than `calibration`
render::Picture read_photograph(const std::filesystem::path& file, const cosim::Calibration& calibration);

/// A picture as the lens makes it, as an ideal lens of the same focal lengths and principal point would: linear between pixels, black where
/// the photograph shows nothing.
render::Picture undistorted(const render::Picture& photograph, const cosim::Calibration& calibration);

/// Both pictures through each other: (1 - share) real + share simulated.
/// @param share  [1] in [0, 1]  @throws InputError if their sizes differ
render::Picture blended(const render::Picture& real, const render::Picture& simulated, Real share = 0.5);

/// Pictures of one size in rows of `columns`, made smaller where the whole would be wider than `width` px; its sides are even. What is left
/// of the last row is white.
render::Picture tiled(const std::vector<render::Picture>& pictures, int columns, int width);

/// Colours of marks, red, green, blue.
inline constexpr std::array<std::uint8_t, 3> kRealColor{255, 160, 0}, kSimulatedColor{0, 160, 255};

/// Draws into the undistorted picture of a frame: a ring about the real landmark, with a gap if it is estimated, a cross on the
/// simulated one, and a line between both.
void draw_landmarks(render::Picture& picture, const FrameError& frame);
/// Draws the inner rim of a simulated hub that faces the camera.
void draw_rim(render::Picture& picture, const render::Camera& camera, const Hub& hub);
}  // namespace tape::score
