#pragma once
#include <filesystem>
#include <memory>

#include "apps/render/picture.hpp"
#include "tape/core/settings.hpp"

namespace tape::video {
struct VideoSettings {
  int width = 1280, height = 720;  ///< [px]  even, as H.264 with yuv420p asks
  Real rate = 30;                  ///< [1/s] pictures per second of the video
  int quality = 20;                ///< [1]   constant rate factor of libx264: smaller is better and larger
  template <class F>
  void fields(F&& f) {
    f("width", width, "px", Range::closed(16, 7680), "width, even");
    f("height", height, "px", Range::closed(16, 4320), "height, even");
    f("rate", rate, "1/s", Range::closed(0.1, 1000), "pictures per second");
    f("quality", quality, "", Range::closed(0, 51), "constant rate factor of libx264; smaller is better");
  }
};

/// @throws SettingsError for a value out of range or an odd size
void require_valid(const VideoSettings& settings);
/// @throws InputError where ffmpeg is missing: to be found before anything is simulated for a video
void require_ffmpeg();

/// H.264 video in an mp4 file that browsers play while they load it, made by the program ffmpeg, which runs beside and reads the
/// pictures from a socket. The file has a temporary name until `finish`; without `finish` nothing is left behind.
class VideoWriter {
 public:
  /// @throws SettingsError, or InputError where ffmpeg is missing
  VideoWriter(const std::filesystem::path& path, const VideoSettings& settings);
  ~VideoWriter();
  VideoWriter(VideoWriter&&) noexcept;
  VideoWriter& operator=(VideoWriter&&) noexcept;
  /// @throws InputError for a picture of another size, or with ffmpeg's own words where it has failed
  void add(const render::Picture& picture);
  /// Waits for ffmpeg and gives the file its name.  @throws InputError with ffmpeg's own words where it has failed
  void finish();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};
}  // namespace tape::video
