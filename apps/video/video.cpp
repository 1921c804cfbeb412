#include "apps/video/video.hpp"

#include "apps/video/process.hpp"
#include "tape/core/error.hpp"

namespace tape::video {
namespace {
/// Raw RGB on standard input; colours converted and tagged as BT.709, which is what browsers assume.
std::vector<std::string> ffmpeg_command(const VideoSettings& s, const std::filesystem::path& file) {
  const std::string size = std::to_string(s.width) + "x" + std::to_string(s.height);
  return {"ffmpeg",
          "-nostdin",
          "-hide_banner",
          "-loglevel",
          "error",
          "-y",
          "-f",
          "rawvideo",
          "-pix_fmt",
          "rgb24",
          "-video_size",
          size,
          "-framerate",
          to_text(s.rate),
          "-i",
          "pipe:0",
          "-vf",
          "scale=out_color_matrix=bt709:out_range=tv,format=yuv420p",
          "-colorspace",
          "bt709",
          "-color_primaries",
          "bt709",
          "-color_trc",
          "bt709",
          "-color_range",
          "tv",
          "-c:v",
          "libx264",
          "-preset",
          "veryfast",
          "-crf",
          std::to_string(s.quality),
          "-movflags",
          "+faststart",
          "-f",
          "mp4",
          "file:" + file.string()};
}
}  // namespace

void require_valid(const VideoSettings& s) {
  tape::require_valid(s, "video");
  for (const auto& [name, value] : {std::pair{"video.width", s.width}, std::pair{"video.height", s.height}})
    if (value % 2) throw SettingsError(name, std::to_string(value), "an even number of px");
}

void require_ffmpeg() {
  Process version({"ffmpeg", "-version"});
  if (!version.wait()) throw InputError("ffmpeg -version fails: " + version.messages());
}

struct VideoWriter::Impl {
  struct Part {  // outlives ffmpeg, so that nothing is left behind
    std::filesystem::path path;
    ~Part() {
      std::error_code ignored;
      std::filesystem::remove(path, ignored);
    }
  };
  std::filesystem::path path;
  VideoSettings settings;
  Part part;
  Process ffmpeg;
  Impl(const std::filesystem::path& p, const VideoSettings& s)
      : path(p), settings(s), part{p.string() + ".part"}, ffmpeg(ffmpeg_command(settings, part.path)) {}
  [[noreturn]] void fail() const { throw InputError(path.string() + ": ffmpeg failed: " + ffmpeg.messages()); }
};

VideoWriter::VideoWriter(const std::filesystem::path& path, const VideoSettings& settings) {
  require_valid(settings);
  impl_ = std::make_unique<Impl>(path, settings);
}
VideoWriter::~VideoWriter() = default;
VideoWriter::VideoWriter(VideoWriter&&) noexcept = default;
VideoWriter& VideoWriter::operator=(VideoWriter&&) noexcept = default;

void VideoWriter::add(const render::Picture& picture) {
  const VideoSettings& s = impl_->settings;
  if (picture.width != s.width || picture.height != s.height)
    throw InputError("video: a picture of " + std::to_string(picture.width) + " x " + std::to_string(picture.height) +
                     " px for a video of " + std::to_string(s.width) + " x " + std::to_string(s.height) + " px");
  if (impl_->ffmpeg.send(picture.rgb)) return;
  impl_->ffmpeg.wait();
  impl_->fail();
}

void VideoWriter::finish() {
  if (!impl_->ffmpeg.wait()) impl_->fail();
  std::error_code failure;
  std::filesystem::rename(impl_->part.path, impl_->path, failure);
  if (failure) throw InputError(impl_->path.string() + ": cannot write the video: " + failure.message());
}
}  // namespace tape::video
