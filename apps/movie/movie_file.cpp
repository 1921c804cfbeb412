#include "apps/movie/movie_file.hpp"

namespace tape::movie {
namespace {
video::VideoSettings video_settings(const PictureParams& params, const Movie& movie) {
  video::VideoSettings settings = params.video;
  settings.width = movie.width(), settings.height = movie.height();  // a calibrated camera brings its own size
  return settings;
}
}  // namespace

MovieFile::MovieFile(const PictureParams& params, const Stage& stage, const RecordedMesh& mesh, const RecordedFrame& first,
                     std::filesystem::path file)
    : file_(std::move(file)),
      movie_(params, stage, mesh, first, [this](const render::Picture& picture) { video_.add(picture); }),
      video_(file_, video_settings(params, movie_)) {}

void MovieFile::finish() {
  movie_.finish();
  video_.finish();
  for (const Movie::Still& still : movie_.stills())
    render::write_png(file_.parent_path() / ("still_" + still.phase + ".png"), still.picture);
}

bool write_video(const cosim::StateReader& recording, const PictureParams& params, const std::filesystem::path& file, const Watch& watch) {
  const Stage stage = stage_of(recording, params);
  MovieFile movie(params, stage, recording.mesh(), recording.frame(0), file);
  for (int i = 0; i < recording.frames(); ++i) {
    const RecordedFrame frame = recording.frame(i);
    movie.add(recording.mesh(frame.mesh), frame);
    if (!watch(i + 1, recording.frames())) return false;
  }
  movie.finish();
  return true;
}

void write_still(const cosim::StateReader& recording, const PictureParams& params, int frame, const std::filesystem::path& file) {
  const Stage stage = stage_of(recording, params);
  const int index = frame < 0 ? frame + recording.frames() : frame;
  if (index < 0 || index >= recording.frames())
    throw SettingsError("--still", std::to_string(frame), Range::closed(-recording.frames(), recording.frames() - 1).text());
  Studio studio(params, stage, recording.mesh(), recording.frame(0));
  for (int i = 0; i <= index; ++i) {
    const RecordedFrame state = recording.frame(i);
    studio.show(recording.mesh(state.mesh), state);
  }
  render::write_png(file, studio.picture());
}
}  // namespace tape::movie
