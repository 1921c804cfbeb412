#pragma once
#include <filesystem>
#include <optional>
#include <variant>
#include <vector>

#include "apps/render/camera.hpp"
#include "apps/render/colors.hpp"
#include "apps/video/video.hpp"
#include "cosim/run/state_file.hpp"
#include "cosim/scene/reader.hpp"

namespace tape::tapesim {
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
/// One camera of section `camera`: by where it looks, or calibrated.
using CameraParams = std::variant<render::LookAtSettings, render::PinholeSettings>;
struct PictureParams {
  ViewParams view;
  video::VideoSettings video;
  std::vector<CameraParams> cameras;  ///< side by side; none: one that takes in the whole motion of what moves
};
/// Sections `video` and `camera` of a file.
PictureParams read_pictures(const cosim::Reader& root);
/// What stands in `camera`: a camera, or a list of them; `fx` and the like make one a calibrated one.
std::vector<CameraParams> read_cameras(const cosim::Reader& camera);
/// A camera file: the keys of a `camera` section, or a file with such a section.
std::vector<CameraParams> load_cameras(const std::filesystem::path& file);
/// As text that a recording can keep, and back.
std::string camera_text(const std::vector<CameraParams>& cameras);
std::vector<CameraParams> parse_cameras(const std::string& text);

/// @throws InputError where no video can be made so, before anything is simulated for it
void require_video(const PictureParams& params);
/// The whole recording, at the speed of the simulation. Shows its progress.
/// @return false if it was interrupted: there is no file then
bool write_video(const cosim::StateReader& recording, const PictureParams& params, const std::filesystem::path& file);
/// One recorded state. @param frame  counted from 0; negative: from the end
void write_still(const cosim::StateReader& recording, const PictureParams& params, int frame, const std::filesystem::path& file);
}  // namespace tape::tapesim
