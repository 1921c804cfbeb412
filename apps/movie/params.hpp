#pragma once
#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "apps/render/camera.hpp"
#include "apps/render/colors.hpp"
#include "apps/video/video.hpp"
#include "cosim/scene/reader.hpp"

namespace tape::movie {
/// How a recording is shown: section `video` of a scene.
struct ViewParams {
  render::ColorBy color = render::ColorBy::material;
  bool ground = true;
  Real track = -1;
  template <class F>
  void fields(F&& f) {
    f("color", color, "", Range::any(), "what colours mean");
    f("ground", ground, "", Range::any(), "a ground with lines each 10 mm at the lowest point of the scene");
    f("track", track, "m", Range::closed(-1, 100), "paints the row of the first strip that lies here at rest; negative: none");
  }
};

enum class Corner { bottom_right, bottom_left, top_right, top_left };
constexpr auto enum_names(Corner) { return std::array<std::string_view, 4>{"bottom_right", "bottom_left", "top_right", "top_left"}; }
/// Where the picture of a camera stands in the whole one.
struct InsetParams {
  Corner corner = Corner::bottom_right;
  Real width = 0.33;
  template <class F>
  void fields(F&& f) {
    f("corner", corner, "", Range::any(), "of the whole picture, where that of the camera stands");
    f("width", width, "", Range::closed(0.05, 0.9), "share of the whole picture's width, and of its height");
  }
};
/// One camera of section `camera`: by where it looks, or calibrated.
struct CameraParams {
  std::variant<render::LookAtSettings, render::PinholeSettings> lens;
  std::optional<InsetParams> inset = {};  ///< none: it stands beside the others
};

struct PictureParams {
  ViewParams view;
  video::VideoSettings video;
  std::vector<CameraParams> cameras;  ///< none: one that takes in the whole motion of what moves
  std::vector<std::string> overlay;   ///< grips, and links as robot:link, whose force is shown
};
/// Sections `video` and `camera` of a file.
/// @param bearers  what may be named in the overlay
PictureParams read_pictures(const cosim::Reader& root, const std::vector<std::string>& bearers);
/// What stands in `camera`: a camera, or a list of them; `fx` and the like make one a calibrated one.
std::vector<CameraParams> read_cameras(const cosim::Reader& camera);
/// A camera file: the keys of a `camera` section, or a file with such a section.
std::vector<CameraParams> load_cameras(const std::filesystem::path& file);
/// As text that a recording can keep, and back.
std::string pictures_text(const PictureParams& params);
PictureParams parse_pictures(const std::string& text, const std::vector<std::string>& bearers);

/// @throws InputError where no video can be made so, before anything is simulated for it
void require_video(const PictureParams& params);
}  // namespace tape::movie
